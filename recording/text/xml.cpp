#include "recording/text/xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

constexpr int kDeepest = 32;

class XmlReader {
 public:
  XmlReader(std::string file, std::string text) : file_(std::move(file)), text_(std::move(text)) {}

  XmlElement Read() {
    XmlElement top;
    ReadChildren(top, 0);
    if (top.children.size() != 1) throw Error("expected one element at the top");
    return top.children.front();
  }

 private:
  InputError Error(const std::string& what) const { return InputError::At(file_, Line(), what); }
  /// The line of the place, counted on from where it was asked for last: once over the file.
  long Line() const {
    line_ += std::count(text_.begin() + std::ptrdiff_t(counted_),
                        text_.begin() + std::ptrdiff_t(at_), '\n');
    counted_ = at_;
    return line_;
  }

  bool Skip(const std::string& begin, const std::string& end) {
    if (text_.compare(at_, begin.size(), begin) != 0) return false;
    const auto close = text_.find(end, at_ + begin.size());
    if (close == std::string::npos) throw Error(fmt::format("{} without {}", begin, end));
    at_ = close + end.size();
    return true;
  }

  void ReadChildren(XmlElement& parent, int depth) {
    if (depth > kDeepest) throw Error(fmt::format("elements nested more than {} deep", kDeepest));
    while (true) {
      const std::size_t next = std::min(text_.find('<', at_), text_.size());
      parent.text.append(text_, at_, next - at_);
      at_ = next;
      if (at_ == text_.size()) {
        if (depth > 0) throw Error(fmt::format("<{}> is not closed", parent.name));
        return;
      }
      if (Skip("<!--", "-->") || Skip("<?", "?>") || Skip("<!", ">")) continue;
      if (text_.compare(at_, 2, "</") == 0) {
        at_ += 2;
        const std::string name = Name();
        if (name != parent.name || depth == 0)
          throw Error(fmt::format("</{}> closes nothing", name));
        at_ = std::min(text_.find('>', at_), text_.size() - 1) + 1;
        return;
      }
      ReadElement(parent, depth);
    }
  }

  void ReadElement(XmlElement& parent, int depth) {
    XmlElement element;
    element.line = Line();
    ++at_;
    element.name = Name();
    while (true) {
      Blanks();
      if (at_ >= text_.size()) throw Error(fmt::format("<{}> has no end", element.name));
      if (text_[at_] == '>') {
        ++at_;
        ReadChildren(element, depth + 1);
        break;
      }
      if (text_.compare(at_, 2, "/>") == 0) {
        at_ += 2;
        break;
      }
      const std::string key = Name();
      Blanks();
      if (at_ + 1 >= text_.size() || text_[at_] != '=') throw Error("expected =");
      ++at_;
      Blanks();
      const char quote = at_ < text_.size() ? text_[at_] : ' ';
      if (quote != '"' && quote != '\'') throw Error("expected a value in quotes");
      const auto close = text_.find(quote, at_ + 1);
      if (close == std::string::npos) throw Error("a quote is not closed");
      element.attributes[key] = text_.substr(at_ + 1, close - at_ - 1);
      at_ = close + 1;
    }
    parent.children.push_back(std::move(element));
  }

  void Blanks() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }
  std::string Name() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && !std::isspace(static_cast<unsigned char>(text_[at_])) &&
           text_[at_] != '>' && text_[at_] != '=' && text_[at_] != '/')
      ++at_;
    if (at_ == begin) throw Error("expected a name");
    return text_.substr(begin, at_ - begin);
  }

  std::string file_, text_;
  std::size_t at_ = 0;  ///< never goes back
  mutable std::size_t counted_ = 0;
  mutable long line_ = 1;
};

}  // namespace

std::string ResolvedEntities(std::string_view text) {
  static constexpr std::array<std::pair<std::string_view, char>, 5> kEntities = {
      {{"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}, {"&apos;", '\''}, {"&quot;", '"'}}};
  std::string resolved;
  for (std::size_t i = 0; i < text.size();) {
    const auto entity = std::find_if(kEntities.begin(), kEntities.end(), [&](const auto& one) {
      return text.substr(i, one.first.size()) == one.first;
    });
    resolved += entity == kEntities.end() ? text[i] : entity->second;
    i += entity == kEntities.end() ? 1 : entity->first.size();
  }
  return resolved;
}

const XmlElement* XmlElement::Child(const std::string& child) const {
  const auto found = std::find_if(children.begin(), children.end(),
                                  [&](const XmlElement& e) { return e.name == child; });
  return found == children.end() ? nullptr : &*found;
}

XmlElement ReadXml(const std::filesystem::path& file) {
  return XmlReader(file.string(), ReadTextFile(file)).Read();
}

}  // namespace flextip
