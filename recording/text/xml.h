// XML as far as files of robots and cameras need it.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace flextip {

struct XmlElement {
  std::string name;
  std::map<std::string, std::string> attributes;
  std::vector<XmlElement> children;
  std::string text;  ///< between its tags, without its children's; entities as they stand
  long line = 0;

  /// Returns the first child of that name; null where there is none.
  const XmlElement* Child(const std::string& child) const;
};

/// Returns `text` with XML's five entities (&lt; and so on) as what they stand for.
std::string ResolvedEntities(std::string_view text);

/// Reads the file's one element at the top. Comments and declarations are passed over. Throws
/// InputError with file and line where it is no XML, or elements are nested more than 32 deep.
XmlElement ReadXml(const std::filesystem::path& file);

}  // namespace flextip
