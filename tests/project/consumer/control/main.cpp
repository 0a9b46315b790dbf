// A step of a controller from a measured tip, with the component control alone.
#include <cstdio>

#include <flextip/control/controller.h>

int main() {
  flextip::ControlInput input;
  input.p_RE_desired = {0.6, 0.001, 0.0};
  input.p_RE_measured = {0.6, 0.0, 0.0};
  input.tip_measured = true;
  input.model.instrument = {0.6, 0.00238, 0.304, 0.0};
  input.model.p_RP = {0.28, 0.0, 0.0};
  input.model.force_known = true;
  const flextip::ControlOutput output = flextip::TipController({}).Step(input);
  std::printf("wrist steps %.6f m in y, %s\n", output.p_RW_command.y() - input.p_RW.y(),
              Name(output.status));
  return output.status == flextip::ControlStatus::kOk ? 0 : 1;
}
