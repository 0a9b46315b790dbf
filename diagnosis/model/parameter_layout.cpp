#include "diagnosis/model/parameter_layout.h"

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
    Append(own);
  }
}

int ParameterLayout::Find(const std::string& effect) const {
  for (int b = 0; b < effect_count_; ++b)
    if (blocks_[b].effect->Name() == effect) return b;
  return -1;
}

}  // namespace flextip::diagnosis
