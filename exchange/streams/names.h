// The streams that files can hold, and the words that tell them.
#pragma once

#include <string>
#include <vector>

namespace flextip::exchange {

/// wrist0, command0, em0, em1, strain0, load0: of tables and of bags.
const std::vector<std::string>& TableStreams();
/// joints0, joints_command0, torque0: of bags alone.
const std::vector<std::string>& JointStreams();

bool IsTableStream(const std::string& stream);
bool IsJointStream(const std::string& stream);
bool IsCamera(const std::string& stream);  ///< cam0, cam1
/// "wrist0, command0, em0, em1, strain0 or load0".
std::string TableStreamsText();

/// "posX_mm [m]" in small words: pos, x, mm.
std::vector<std::string> WordsOf(const std::string& name);

/// The stream that a name's words tell ("aurora.csv": em0); empty where they tell none.
std::string StreamNamed(const std::string& name);

}  // namespace flextip::exchange
