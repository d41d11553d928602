#include <fmt/format.h>

#include <algorithm>

#include "talus/base/file.hpp"
#include "talus/base/text.hpp"
#include "talus/input/reader.hpp"

namespace talus {

namespace {

constexpr std::size_t most_bytes = 1 << 20;  // a polygon of ten thousand corners has a quarter of it
constexpr int deepest = 16;

/// Where brackets or dotted keys go deeper than in any input, or npos. toml++ makes and removes every level by a call
/// of its own; a deep text would use up the stack.
std::size_t too_deep(std::string_view text) {
  int brackets = 0, dots = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if (c == '"' || c == '\'') {
      const std::size_t n = text.substr(i, 3) == std::string(3, c) ? 3 : 1;
      const std::string mark(n, c);
      for (i += n; i < text.size() && text.substr(i, n) != mark && (n == 3 || text[i] != '\n'); ++i)
        if (c == '"' && text[i] == '\\') ++i;
      i += n - 1;
      for (int more = 0; n == 3 && more < 2 && i + 1 < text.size() && text[i + 1] == c; ++more) ++i;  // """a"""""
    } else if (c == '.') {
      if (++dots > deepest) return i;
    } else if (c == '[' || c == '{') {
      dots = 0;
      if (++brackets > deepest) return i;
    } else if (c == ']' || c == '}') {
      dots = 0;
      --brackets;
    } else if (c == ',' || c == '=' || c == '\n') {
      dots = 0;
    }
  }
  return text.npos;
}

toml::table parse(const std::string& name, std::string_view text) {
  if (text.size() > most_bytes)
    throw InputError({Complaint{name, 0, 0,
                                fmt::format("holds {} bytes; at most {} are read. Long lists belong into CSV files",
                                            text.size(), most_bytes)}});
  if (const std::size_t at = too_deep(text); at != text.npos) {
    const std::string_view before = text.substr(0, at);
    throw InputError({Complaint{name, 1 + int(std::count(before.begin(), before.end(), '\n')),
                                int(at - (before.rfind('\n') + 1)) + 1,
                                fmt::format("brackets or dotted keys go deeper than {} levels", deepest)}});
  }
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& e) {
    throw InputError({Complaint{name, int(e.source().begin.line), int(e.source().begin.column),
                                printable(std::string(e.description()))}});
  }
}

std::string read_text(const std::string& path) {
  try {
    return contents_of(path, most_bytes);
  } catch (const std::runtime_error& e) {
    throw InputError(e.what());
  }
}

}  // namespace

Document::Document(const std::string& path) : Document(path, read_text(path)) {}

Document::Document(const std::string& name, std::string_view text) : name_(name), root_(parse(name, text)) {}

void Document::complain(const toml::source_region& where, std::string text) {
  if (where.path && *where.path != name_) {  // a value that was replaced
    complaints_.push_back({printable(*where.path), 0, 0, printable(text)});
    return;
  }
  const toml::source_position& at = where.begin ? where.begin : root_.source().begin;  // a section that is not there
  complaints_.push_back({name_, int(at.line), int(at.column), printable(text)});
}

void Document::complain(const InputError& other) {
  complaints_.insert(complaints_.end(), other.complaints().begin(), other.complaints().end());
}

void Document::finish() const {
  if (!complaints_.empty()) throw InputError(complaints_);
}

}  // namespace talus
