// What sensors that stamp late say of each sample's own time: their streams read later by the
// delay.
#pragma once

#include <vector>

#include "diagnosis/sample_set.h"

namespace flextip {

/// Reads the streams of a sample set at other times, by the cubic through four of a sensor's
/// values.
class Retiming {
 public:
  explicit Retiming(const SampleSet& samples);

  /// Sample `k` with the EM sensor's and the camera's values of `t_k + delay`, the gages' and the
  /// port sensor's of `t_k`. Where a stream does not reach that far, its own nearest value.
  DiagnosisSample At(std::size_t k, double em_delay_s, double camera_delay_s) const;

 private:
  struct Stream {  // samples in which a sensor spoke, and when
    std::vector<std::size_t> k;
    std::vector<double> t_s;
  };
  template <class Get>
  Stream MakeStream(int first_row, Get dt_s) const;
  template <class Value>
  void Read(const Stream& stream, double dt_s, double delay_s, Value DiagnosisSample::*value,
            DiagnosisSample& at) const;

  const SampleSet& samples_;
  Stream em_, strain_, tip_, tip_direction_, port_;
};

}  // namespace flextip
