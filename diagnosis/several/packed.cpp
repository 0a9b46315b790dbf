#include "diagnosis/several/packed.h"

#include <cereal/archives/binary.hpp>
#include <cereal/types/array.hpp>
#include <cereal/types/map.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/variant.hpp>
#include <cereal/types/vector.hpp>
#include <sstream>

#include "core/error.h"

namespace cereal {

template <class Archive, int kRows, int kColumns>
void save(Archive& archive, const Eigen::Matrix<double, kRows, kColumns>& matrix) {
  archive(std::int64_t(matrix.rows()), std::int64_t(matrix.cols()));
  archive(binary_data(matrix.data(), std::size_t(matrix.size()) * sizeof(double)));
}

template <class Archive, int kRows, int kColumns>
void load(Archive& archive, Eigen::Matrix<double, kRows, kColumns>& matrix) {
  std::int64_t rows = 0, columns = 0;
  archive(rows, columns);
  matrix.resize(rows, columns);
  archive(binary_data(matrix.data(), std::size_t(matrix.size()) * sizeof(double)));
}

}  // namespace cereal

namespace flextip::diagnosis {

// Every member of a struct has a name here: with one more or one less this does not compile.

template <class Archive>
void serialize(Archive& archive, NormalSums& of) {
  auto& [H, g, c, volume, rows] = of;
  archive(H, g, c, volume, rows);
}
template <class Archive>
void serialize(Archive& archive, Place& of) {
  auto& [theta, forces, centres] = of;
  archive(theta, forces, centres);
}
template <class Archive>
void serialize(Archive& archive, MemberState& of) {
  auto& [place, sums, far] = of;
  archive(place, sums, far);
}
template <class Archive>
void serialize(Archive&, NoEquilibrium&) {}
template <class Archive>
void serialize(Archive& archive, MemberSums& of) {
  auto& [narrow, wide, bags, wide_bags, as_one, chi2] = of;
  archive(narrow, wide, bags, wide_bags, as_one, chi2);
}

template <class Archive>
void serialize(Archive& archive, ToBase& of) {
  auto& [scan_shared, centres] = of;
  archive(scan_shared, centres);
}
template <class Archive>
void serialize(Archive& archive, ToPlace& of) {
  auto& [place] = of;
  archive(place);
}
template <class Archive>
void serialize(Archive& archive, Remeasure& of) {
  auto& [place] = of;
  archive(place);
}
template <class Archive>
void serialize(Archive& archive, SumUp& of) {
  auto& [place, bags] = of;
  archive(place, bags);
}
template <class Archive>
void serialize(Archive& archive, MemberContext& of) {
  auto& [known, present, common, names, converged, fits, bags, start, first, last] = of;
  archive(known, present, common, names, converged, fits, bags, start, first, last);
}
template <class Archive>
void serialize(Archive& archive, Judge& of) {
  auto& [place, context] = of;
  archive(place, context);
}
template <class Archive>
void serialize(Archive& archive, MemberTask& of) {
  auto& [member, what] = of;
  archive(member, what);
}

template <class Archive>
void serialize(Archive& archive, ReportedParameter& of) {
  auto& [name, value, sd, may_be_missing] = of;
  archive(name, value, sd, may_be_missing);
}
template <class Archive>
void serialize(Archive& archive, EffectFit& of) {
  auto& [effect, parameters] = of;
  archive(effect, parameters);
}
template <class Archive>
void serialize(Archive& archive, HypothesisProbability& of) {
  auto& [verdict, probability, log_evidence] = of;
  archive(verdict, probability, log_evidence);
}
template <class Archive>
void serialize(Archive& archive, SensorTolerance& of) {
  auto& [effects, covariance] = of;
  archive(effects, covariance);
}
template <class Archive>
void serialize(Archive& archive, ModelScore& of) {
  auto& [heldout, tip, weighted, chi2] = of;
  archive(heldout, tip, weighted, chi2);
}
template <class Archive>
void serialize(Archive& archive, Gain& of) {
  auto& [measured, ratio, tip, low, high] = of;
  archive(measured, ratio, tip, low, high);
}
template <class Archive>
void serialize(Archive& archive, Signature& of) {
  auto& [channel, against, score] = of;
  archive(channel, against, score);
}
template <class Archive>
void serialize(Archive& archive, Term& of) {
  auto& [target, shape, variable, at, amplitude, offset] = of;
  archive(target, shape, variable, at, amplitude, offset);
}
template <class Archive>
void serialize(Archive& archive, TermName& of) {
  auto& [channel, depends_on, form] = of;
  archive(channel, depends_on, form);
}
template <class Archive>
void serialize(Archive& archive, TermRegion& of) {
  auto& [largest, part, depth_low, depth_high, low, high] = of;
  archive(largest, part, depth_low, depth_high, low, high);
}
template <class Archive>
void serialize(Archive& archive, TermPicture& of) {
  auto& [variable, term, measured] = of;
  archive(variable, term, measured);
}
template <class Archive>
void serialize(Archive& archive, Discovered& of) {
  auto& [term, name, frame, direction, parameters, text, false_discovery, stability, could_be,
         region, picture, gain] = of;
  archive(term, name, frame, direction, parameters, text, false_discovery, stability, could_be,
          region, picture, gain);
}
template <class Archive>
void serialize(Archive& archive, ResidualTable& of) {
  auto& [columns, rows, present] = of;
  archive(columns, rows, present);
}
template <class Archive>
void serialize(Archive& archive, ResidualMemory& of) {
  auto& [channel, correlation, slow] = of;
  archive(channel, correlation, slow);
}
template <class Archive>
void serialize(Archive& archive, NextMotion& of) {
  auto& [needed, rivals, places, speed, load, seconds, certain, probability, least_sure, now,
         library, library_certain, library_probability] = of;
  archive(needed, rivals, places, speed, load, seconds, certain, probability, least_sure, now,
          library, library_certain, library_probability);
}
template <class Archive>
void serialize(Archive& archive, DiagnosisResult& of) {
  auto& [verdict, probabilities, presence, credible, groups, motion, motion_score, plan, parameters,
         within, discovered, covariance, tolerance, centre, start, base, extended, gain, memory,
         signatures, residuals, noise_scale, noise_sd, nominal, samples, failed, fits, converged,
         has_load, catalogue, summaries, warnings] = of;
  archive(verdict, probabilities, presence, credible, groups, motion, motion_score, plan,
          parameters, within, discovered, covariance, tolerance, centre, start, base, extended,
          gain, memory, signatures, residuals, noise_scale, noise_sd, nominal, samples, failed,
          fits, converged, has_load, catalogue, summaries, warnings);
}
template <class Archive>
void serialize(Archive& archive, ErrorSums& of) {
  auto& [squares, weighted, count, tip, distances, tip_count] = of;
  archive(squares, weighted, count, tip, distances, tip_count);
}
template <class Archive>
void serialize(Archive& archive, HeldOut& of) {
  auto& [base, extended, gain, base_sums, extended_sums] = of;
  archive(base, extended, gain, base_sums, extended_sums);
}
template <class Archive>
void serialize(Archive& archive, JudgedMember& of) {
  auto& [own, heldout, parameters, within, covariance, tolerance, groups, motion, score] = of;
  archive(own, heldout, parameters, within, covariance, tolerance, groups, motion, score);
}

namespace {

template <class T>
std::string Packed(const T& value) {
  std::ostringstream stream(std::ios::binary);
  cereal::BinaryOutputArchive{stream}(value);
  return std::move(stream).str();
}

template <class T>
T Unpacked(const std::string& bytes) {
  std::istringstream stream(bytes, std::ios::binary);
  T value;
  cereal::BinaryInputArchive{stream}(value);
  return value;
}

struct Reply {
  std::string refusal;  // empty: none
  std::vector<MemberAnswer> answers;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(refusal, answers);
  }
};

}  // namespace

std::string Pack(const std::vector<MemberTask>& tasks) { return Packed(tasks); }
std::vector<MemberTask> UnpackTasks(const std::string& bytes) {
  return Unpacked<std::vector<MemberTask>>(bytes);
}

std::string PackReply(const std::vector<MemberAnswer>& answers) {
  return Packed(Reply{"", answers});
}
std::string PackRefusal(const std::string& why) { return Packed(Reply{why, {}}); }
std::vector<MemberAnswer> UnpackReply(const std::string& bytes) {
  Reply reply = Unpacked<Reply>(bytes);
  if (!reply.refusal.empty()) throw WorkError(reply.refusal);
  return std::move(reply.answers);
}

}  // namespace flextip::diagnosis
