#include <cmath>

#include "recording/arm/arm_file.h"
#include "tests/fuzz/files/input_folder.h"
#include "tests/fuzz/files/inputs.h"

namespace flextip {
namespace {

bool Near(const Pose& pose) {
  return pose.R.allFinite() && pose.p.allFinite() && pose.p.cwiseAbs().maxCoeff() <= 1e8;
}

void RequireInBounds(const Arm& arm) {
  Require(arm.Size() >= 1 && arm.Size() <= 32);
  Require(arm.links.empty() || arm.links.size() == arm.joints.size());
  for (const ArmJoint& joint : arm.joints) {
    Require(Near(joint.before) && Near(joint.after));
    Require(std::abs(joint.axis.norm() - 1.0) < 1e-9 && std::isfinite(joint.zero));
  }
  for (const ArmLink& link : arm.links)
    Require(link.mass_kg >= 0.0 && link.mass_kg <= 1e5 && link.com_m.allFinite());
  for (const PayloadPlace& place : arm.payload_places)
    Require(place.MovesWith() >= 1 && place.MovesWith() <= arm.Size());
}

}  // namespace

int CheckArmInput(std::span<const std::uint8_t> input) {
  static const InputFolder folder;
  const std::string_view text = TextOf(input);
  const bool urdf = text.starts_with('<');
  const auto file = folder.Write(urdf ? "arm.urdf" : "arm.yaml", text);
  ReadLog log;
  Arm arm;
  if (!ReadsOrRefuses([&] { arm = ReadArm(file, log); })) return 0;
  RequireInBounds(arm);
  if (urdf) return 1;  // which has no form to be written in
  WriteArm(folder / "again.yaml", arm);
  const Arm again = ReadArm(folder / "again.yaml", log);
  Require(again.Size() == arm.Size() && again.links.size() == arm.links.size());
  Require(again.payload_places.size() == arm.payload_places.size());
  return 1;
}

}  // namespace flextip
