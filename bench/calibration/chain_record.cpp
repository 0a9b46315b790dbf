#include "bench/calibration/chain_record.h"

#include <nlohmann/json.hpp>

#include "batch/line_file.h"
#include "core/error.h"

namespace flextip::bench {
namespace {

using Json = nlohmann::ordered_json;

template <class Fixed>
Json JsonOf(const std::vector<Fixed>& list) {
  Json json = Json::array();
  for (const Fixed& one : list)
    json.push_back(std::vector<double>(one.data(), one.data() + one.size()));
  return json;
}

template <class Fixed>
std::vector<Fixed> ListOf(const Json& json) {
  std::vector<Fixed> list;
  for (const Json& one : json) {
    list.emplace_back();
    for (Eigen::Index i = 0; i < list.back().size(); ++i) list.back().data()[i] = one.at(i);
  }
  return list;
}

ChainRun RunOf(const Json& json) {
  ChainRun run;
  for (const auto& [part, errors] : json.at("error_V_m").items()) {
    run.error_V[part] = ListOf<Eigen::Vector3d>(errors);
  }
  for (const auto& [part, claimed] : json.at("claimed_m").items()) {
    run.claimed_m[part] = ListOf<Eigen::Vector2d>(claimed);
  }
  run.claimed_V = ListOf<Eigen::Matrix3d>(json.at("claimed_V_m2"));
  return run;
}

}  // namespace

std::string JsonLine(unsigned seed, const ChainRun& run) {
  Json errors, claimed;
  for (const auto& [part, list] : run.error_V) errors[part] = JsonOf(list);
  for (const auto& [part, list] : run.claimed_m) claimed[part] = JsonOf(list);
  return Json{{"seed", seed},
              {"error_V_m", errors},
              {"claimed_m", claimed},
              {"claimed_V_m2", JsonOf(run.claimed_V)}}
      .dump();
}

std::map<unsigned, ChainRun> ReadChainRuns(const std::filesystem::path& file) {
  std::map<unsigned, ChainRun> runs;
  long number = 0;
  for (const std::string& line : batch::WholeLines(file)) {
    ++number;
    try {
      const Json json = Json::parse(line);
      runs[json.at("seed")] = RunOf(json);
    } catch (const Json::exception&) {
      throw InputError::At(file.string(), number, "not a repetition of the chain");
    }
  }
  return runs;
}

}  // namespace flextip::bench
