// What sensors that stamp late say of each sample's own time: their streams read later by the
// delay.
#pragma once

#include <vector>

#include "diagnosis/samples/sample_set.h"

namespace flextip::diagnosis {

/// Finds what the sensors measured of a sample's time, if they speak late. A measured value stays
/// as it is, with its own noise; the model is asked for the little time that it is off.
class Retiming {
 public:
  explicit Retiming(const SampleSet& samples);

  /// Sample `k` with the EM sensor's and the camera's values nearest to `t_k + delay`, the gages'
  /// and the port sensor's nearest to `t_k`, each with its time after the sample (dt_..._s).
  DiagnosisSample At(std::size_t k, double em_delay_s, double camera_delay_s) const;

 private:
  struct Stream {  // samples in which a sensor spoke, and when
    std::vector<std::size_t> k;
    std::vector<double> t_s;
  };
  template <class Get>
  Stream MakeStream(int first_row, Get dt_s) const;
  template <class Value>
  void Read(const Stream& stream, double delay_s, Value DiagnosisSample::*value,
            double DiagnosisSample::*dt_s, DiagnosisSample& at) const;

  const SampleSet& samples_;
  Stream em_, strain_, tip_, tip_direction_, port_;
};

}  // namespace flextip::diagnosis
