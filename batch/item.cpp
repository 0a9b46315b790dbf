#include "batch/item.h"

#include <fmt/format.h>
#include <string.h>

#include <charconv>

#include "core/error.h"

namespace flextip::batch {
namespace {

std::string Escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\t') {
      escaped += "\\t";
    } else if (c == '\n') {
      escaped += "\\n";
    } else if (c == '\\') {
      escaped += "\\\\";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string Unescaped(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool marked = text[i] == '\\' && i + 1 < text.size();
    if (marked) ++i;
    plain += marked && text[i] == 't' ? '\t' : marked && text[i] == 'n' ? '\n' : text[i];
  }
  return plain;
}

std::vector<std::string> Fields(std::string_view line) {
  std::vector<std::string> fields;
  while (true) {
    const std::size_t end = line.find('\t');
    fields.push_back(Unescaped(line.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    line.remove_prefix(end + 1);
  }
}

template <class Number>
Number NumberIn(const std::string& field) {
  Number value{};
  const char* end = field.data() + field.size();
  const auto [read, error] = std::from_chars(field.data(), end, value);
  if (error != std::errc() || read != end) {
    throw InputError(fmt::format("found '{}', expected a number", field));
  }
  return value;
}

}  // namespace

std::string StatusText(const Outcome& outcome) {
  switch (outcome.status) {
    case Status::kOk:
      return "ok";
    case Status::kFailed:
      return "failed";
    case Status::kTimedOut:
      return "timed out";
    case Status::kCrashed:
      break;
  }
  const char* name = sigabbrev_np(outcome.signal);
  return name ? fmt::format("crashed SIG{}", name) : fmt::format("crashed {}", outcome.signal);
}

std::string Pack(const Item& item) {
  std::string line = fmt::format("{}\t{}", Escaped(item.name), item.size);
  for (const auto& argument : item.arguments) {
    line += '\t';
    line += Escaped(argument);
  }
  return line;
}

std::string Pack(const Outcome& o) {
  return fmt::format("{}\t{}\t{}\t{}\t{:.6f}\t{}\t{}", Escaped(o.name), static_cast<int>(o.status),
                     o.exit_code, o.signal, o.seconds, Escaped(o.host), Escaped(o.payload));
}

Item UnpackItem(std::string_view line) {
  std::vector<std::string> fields = Fields(line);
  if (fields.size() < 2) throw InputError("found no item, expected a name and a size");
  Item item{fields[0], {}, NumberIn<double>(fields[1])};
  for (std::size_t i = 2; i < fields.size(); ++i) item.arguments.push_back(fields[i]);
  return item;
}

Outcome UnpackOutcome(std::string_view line) {
  const std::vector<std::string> fields = Fields(line);
  if (fields.size() != 7) {
    throw InputError(fmt::format("found {} fields, expected 7 of an item's end", fields.size()));
  }
  const int status = NumberIn<int>(fields[1]);
  if (status < 0 || status > static_cast<int>(Status::kTimedOut)) {
    throw InputError(fmt::format("found status {}, expected 0 to 3", status));
  }
  return {fields[0],
          static_cast<Status>(status),
          NumberIn<int>(fields[2]),
          NumberIn<int>(fields[3]),
          NumberIn<double>(fields[4]),
          fields[5],
          fields[6]};
}

}  // namespace flextip::batch
