#include "diagnosis/model/parameter_layout.h"

#include <algorithm>

#include "diagnosis/effects/mean_load.h"
#include "diagnosis/effects/registration.h"

namespace flextip::diagnosis {

ParameterLayout::ParameterLayout(const SampleSet& samples, Catalogue catalogue)
    : catalogue_(std::move(catalogue)), effect_count_(int(catalogue_.size())) {
  auto registration = std::make_unique<Registration>();
  if (registration->Applies(samples)) catalogue_.push_back(std::move(registration));
  auto load = std::make_unique<MeanLoad>();
  if (load->Applies(samples)) catalogue_.push_back(std::move(load));
  for (int b = 0; b < int(catalogue_.size()); ++b) {
    const auto own = catalogue_[b]->Parameters(samples);
    blocks_.push_back({catalogue_[b].get(), Size(), int(own.size()), b >= effect_count_});
    if (catalogue_[b]->Scanned(samples)) scanned_.push_back(b);
    parameters_.insert(parameters_.end(), own.begin(), own.end());
  }
  tolerances_.resize(Size());
  // A parameter said to be known exactly keeps a sliver of freedom, so that no matrix is singular.
  for (int j = 0; j < Size(); ++j) {
    tolerances_[j] = std::max(parameters_[j].tolerance, 1e-6 * parameters_[j].typical);
    if (tolerances_[j] <= 0.0) tolerances_[j] = 1e-12;
  }
}

Eigen::VectorXd ParameterLayout::Widened(const std::vector<int>& present,
                                         const std::vector<double>& scales) const {
  Eigen::VectorXd sd = tolerances_;
  for (std::size_t i = 0; i < present.size(); ++i) {
    const Block& block = blocks_[present[i]];
    for (int j = block.first; j < block.first + block.size; ++j)
      sd[j] = std::max(sd[j], scales[i] * parameters_[j].typical);
  }
  return sd;
}

int ParameterLayout::Find(const std::string& effect) const {
  for (int b = 0; b < effect_count_; ++b)
    if (blocks_[b].effect->Name() == effect) return b;
  return -1;
}

}  // namespace flextip::diagnosis
