// Rules for what is written: links lead somewhere, lines are short, quoted messages exist.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace flextip {

/// Path below the project's folder -> its text (empty for pictures and other data).
using ProjectTexts = std::map<std::string, std::string>;

/// Returns every file of the project at `root`, without builds and fetched packages.
ProjectTexts ReadProjectTexts(const std::filesystem::path& root);

/// Returns a line for each link of a page to a file or heading that is not there, and for each
/// `docs/...` in a page or source that names no file.
std::vector<std::string> BrokenLinks(const ProjectTexts& texts);

/// Returns a line for each line of text above 100 characters, in pages (but for tables, code,
/// pictures and links that fill a line) and C++ files.
std::vector<std::string> LongLines(const ProjectTexts& texts);

/// Returns a line for each message that the tables of `page` quote in their first column, of which
/// a fixed part is in no string of the project's sources. A "…" stands for what varies.
std::vector<std::string> UnknownMessages(const ProjectTexts& texts, const std::string& page);

/// Returns the table of folders on `page`: folder -> the names in its column "may use", without
/// what stands in brackets.
std::map<std::string, std::set<std::string>> ArrowTable(const ProjectTexts& texts,
                                                        const std::string& page);

/// Returns the beginning of each C++ block of `page` that is not the whole of a file in examples/.
std::vector<std::string> UnknownExamples(const ProjectTexts& texts, const std::string& page);

}  // namespace flextip
