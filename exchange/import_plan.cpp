#include "exchange/import_plan.h"

namespace flextip::exchange {

void ImportPlan::Told(const std::string& key) {
  std::erase_if(assumed, [&](const auto& entry) {
    return entry.first == key || entry.first.starts_with(key + ".");
  });
}

bool IsOfArmAlone(const ImportPlan& plan) {
  return !plan.arm.empty() && !plan.length_m && !plan.outer_diameter_m &&
         !plan.bending_stiffness_Nm2 && !plan.p_RP;
}

std::vector<std::filesystem::path> FilesOf(const ImportPlan& plan) {
  std::vector<std::filesystem::path> files = plan.tables;
  const auto add = [&](const std::filesystem::path& file) {
    if (!file.empty()) files.push_back(file);
  };
  for (const auto& bag : plan.bags) add(bag);
  for (const auto& [name, stream] : plan.streams) add(stream.file);
  for (const auto& [name, camera] : plan.cameras) {
    for (const auto* file : {&camera.video, &camera.camera, &camera.pose, &camera.times.file}) {
      add(*file);
    }
  }
  add(plan.session);
  add(plan.collar);
  add(plan.arm);
  return files;
}

}  // namespace flextip::exchange
