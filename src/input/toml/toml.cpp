// The one C++ file: a TOML text, read by toml++, as a flat list of entries for Fortran.
//
// Every key, table, array and array element is one entry, in the order of the text; a container comes before
// what it holds. No exception crosses the border: what fails is a document with one entry, the mistake.
// Fortran side: sg_toml (toml.f90).
#include <algorithm>
#include <cfenv>
#include <cstdint>
#include <cstring>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

namespace {

// Kinds of entry, the same numbers as in toml.f90.
enum kind_t : std::int32_t { kind_table = 1, kind_array, kind_integer, kind_real, kind_logical, kind_string, kind_other };

// One entry: its place in the tree, from which the path is made when asked for.
struct entry_t {
  kind_t kind;
  std::int64_t parent;     // entry that holds it, -1 at the top
  std::string_view key;    // key in a table
  std::int64_t element;    // index in an array, -1 in a table
  toml::source_position key_place, place;
  std::string_view text;   // value of a string
  std::int64_t integer;    // value of an integer or a logical
  double real;             // value of a real or an integer
};

struct document_t {
  toml::table root;
  std::vector<entry_t> entries;
  std::string mistake;     // what is wrong with the text; empty when nothing is
  toml::source_position mistake_place{};
};

struct child_t {
  std::string_view key;
  std::int64_t element;
  toml::source_position key_place;
  const toml::node* node;
};

void flatten(document_t& document, const child_t& child, std::int64_t parent);

void flatten_table(document_t& document, const toml::table& table, std::int64_t parent) {
  // toml++ keeps keys in alphabetical order; mistakes are reported in the order of the text.
  std::vector<child_t> children;
  for (auto&& [key, node] : table) children.push_back({key.str(), -1, key.source().begin, &node});
  std::sort(children.begin(), children.end(), [](const child_t& a, const child_t& b) {
    return a.key_place.line != b.key_place.line ? a.key_place.line < b.key_place.line
                                                : a.key_place.column < b.key_place.column;
  });
  for (const child_t& child : children) flatten(document, child, parent);
}

void flatten(document_t& document, const child_t& child, std::int64_t parent) {
  const toml::node& node = *child.node;
  entry_t entry{kind_other, parent, child.key, child.element, child.key_place, node.source().begin, {}, 0, 0};
  if (const auto* value = node.as_integer()) {
    entry.kind = kind_integer;
    entry.integer = value->get();
    entry.real = static_cast<double>(value->get());
  } else if (const auto* value = node.as_floating_point()) {
    entry.kind = kind_real;
    entry.real = value->get();
  } else if (const auto* value = node.as_boolean()) {
    entry.kind = kind_logical;
    entry.integer = value->get() ? 1 : 0;
  } else if (const auto* value = node.as_string()) {
    entry.kind = kind_string;
    entry.text = value->get();
  } else if (node.is_table()) {
    entry.kind = kind_table;
  } else if (node.is_array()) {
    entry.kind = kind_array;
  }
  const auto here = static_cast<std::int64_t>(document.entries.size());
  document.entries.push_back(entry);
  if (const toml::table* table = node.as_table()) flatten_table(document, *table, here);
  if (const toml::array* array = node.as_array()) {
    std::int64_t element = 0;
    for (const toml::node& item : *array)
      flatten(document, {{}, element++, item.source().begin, &item}, here);
  }
}

// Dots of one key, and brackets open at one place, beyond which a text is refused: toml++ and what follows here recurse level by
// level, and no deck nests deeper than four.
constexpr std::size_t most_dots = 64, most_open = 64;

// Last character of the string that begins at a quote; the end of the text where it does not end.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const bool is_long = text.substr(at, 3) == std::string(3, quote);
  for (std::size_t i = at + (is_long ? 3 : 1); i < text.size(); ++i) {
    if (text[i] == '\\' && quote == '"') ++i;
    else if (!is_long && (text[i] == quote || text[i] == '\n')) return i;
    else if (is_long && text.substr(i, 3) == std::string(3, quote)) return i + 2;
  }
  return text.size();
}

// Place of the dot or bracket that is one too many; text.size() where there is none.
std::size_t too_deep(std::string_view text) {
  std::size_t dots = 0, open = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '#') i = std::min(text.find('\n', i), text.size());
    if (c == '"' || c == '\'') i = end_of_string(text, i);
    if (c == '[' || c == '{') ++open;
    if ((c == ']' || c == '}') && open > 0) --open;
    if (c == '.') ++dots;
    else if (std::string_view("#\n=,[]{}").find(c) != std::string_view::npos) dots = 0;
    if (dots > most_dots || open > most_open) return i;
  }
  return text.size();
}

// Line and column of a character, from 1; bytes that go on with a character of UTF-8 do not count.
toml::source_position place_of(std::string_view text, std::size_t at) {
  toml::source_position place{1, 1};
  for (const char c : text.substr(0, at)) {
    if (c == '\n') ++place.line, place.column = 1;
    else if ((static_cast<unsigned char>(c) & 0xC0) != 0x80) ++place.column;
  }
  return place;
}

bool is_bare(std::string_view key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

// Path of an entry, such as body[0].shape[1].radius; keys that are no plain words stand in quotes.
std::string path_of(const document_t& document, std::int64_t index) {
  std::vector<std::int64_t> chain;
  for (std::int64_t i = index; i >= 0; i = document.entries[i].parent) chain.push_back(i);
  std::string path;
  for (auto i = chain.rbegin(); i != chain.rend(); ++i) {
    const entry_t& entry = document.entries[*i];
    if (entry.element >= 0) {
      path += '[' + std::to_string(entry.element) + ']';
      continue;
    }
    if (!path.empty()) path += '.';
    if (is_bare(entry.key)) {
      path += entry.key;
    } else {
      path += '"';
      for (char c : entry.key) path += c == '"' ? '\'' : c;
      path += '"';
    }
  }
  return path;
}

}  // namespace

extern "C" {

// What Fortran learns of an entry before it asks for the texts.
struct sg_toml_entry {
  std::int32_t kind, key_line, key_column, line, column;
  std::int64_t parent, path_length, text_length, integer;
  double real;
};

// Parse a text; null when there is no memory for it. Free the document with sg_toml_free.
void* sg_toml_parse(const char* text, std::int64_t length) noexcept {
  document_t* document = new (std::nothrow) document_t;
  if (!document) return nullptr;
  // Numbers too large for a double are refused as infinite ones; builds that trap an overflow must not stop here.
  std::fenv_t environment;
  std::feholdexcept(&environment);
  try {
    try {
      const std::string_view all(text, static_cast<std::size_t>(length));
      const std::size_t deep = too_deep(all);
      if (deep < all.size()) {
        document->mistake = "error: keys or values nest deeper than 64 levels";
        document->mistake_place = place_of(all, deep);
      } else {
        document->root = toml::parse(all);
        flatten_table(*document, document->root, -1);
      }
    } catch (const toml::parse_error& error) {
      document->mistake = error.description().empty() ? "syntax error" : std::string(error.description());
      document->mistake_place = error.source().begin;
    }
  } catch (...) {
    delete document;
    document = nullptr;
  }
  std::fesetenv(&environment);
  return document;
}

void sg_toml_free(void* handle) noexcept { delete static_cast<document_t*>(handle); }

// Number of entries; -1 when the text is wrong: then entry 0 holds the mistake as its text.
std::int64_t sg_toml_count(const void* handle) noexcept {
  const auto* document = static_cast<const document_t*>(handle);
  return document->mistake.empty() ? static_cast<std::int64_t>(document->entries.size()) : -1;
}

void sg_toml_describe(const void* handle, std::int64_t index, sg_toml_entry* described) noexcept {
  const auto* document = static_cast<const document_t*>(handle);
  if (!document->mistake.empty()) {
    const auto place = document->mistake_place;
    *described = {kind_other, static_cast<std::int32_t>(place.line), static_cast<std::int32_t>(place.column),
                  static_cast<std::int32_t>(place.line), static_cast<std::int32_t>(place.column), -1, 0,
                  static_cast<std::int64_t>(document->mistake.size()), 0, 0.0};
    return;
  }
  const entry_t& entry = document->entries[static_cast<std::size_t>(index)];
  std::int64_t path_length = -1;
  try {
    path_length = static_cast<std::int64_t>(path_of(*document, index).size());
  } catch (...) {
  }
  *described = {entry.kind,
                static_cast<std::int32_t>(entry.key_place.line), static_cast<std::int32_t>(entry.key_place.column),
                static_cast<std::int32_t>(entry.place.line), static_cast<std::int32_t>(entry.place.column),
                entry.parent, path_length, static_cast<std::int64_t>(entry.text.size()), entry.integer, entry.real};
}

// Copy path and text into room of the lengths described; false when memory ran out.
bool sg_toml_copy(const void* handle, std::int64_t index, char* path, char* text) noexcept {
  const auto* document = static_cast<const document_t*>(handle);
  if (!document->mistake.empty()) {
    std::memcpy(text, document->mistake.data(), document->mistake.size());
    return true;
  }
  try {
    const std::string name = path_of(*document, index);
    std::memcpy(path, name.data(), name.size());
  } catch (...) {
    return false;
  }
  const std::string_view value = document->entries[static_cast<std::size_t>(index)].text;
  if (!value.empty()) std::memcpy(text, value.data(), value.size());
  return true;
}

}  // extern "C"
