#include "io/cells/detail/xml_tags.h"

#include "core/text_scanner.h"

namespace innermap {
namespace {

bool isXmlSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

std::string resolved(std::string_view text) {
  static constexpr std::pair<std::string_view, char> kEntities[] = {
      {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    bool found = false;
    for (const auto& [entity, character] : kEntities)
      if (text.compare(i, entity.size(), entity) == 0) {
        out += character;
        i += entity.size() - 1;
        found = true;
        break;
      }
    if (!found) out += text[i];
  }
  return out;
}

}  // namespace

std::string XmlTag::attribute(std::string_view wanted) const {
  for (const auto& [known, value] : attributes)
    if (known == wanted) return value;
  return {};
}

void XmlTags::skipSpace() {
  while (position_ < file_.bytes.size() && isXmlSpace(file_.bytes[position_])) ++position_;
}

std::string_view XmlTags::word() {
  const std::size_t begin = position_;
  while (position_ < file_.bytes.size() && !isXmlSpace(file_.bytes[position_]) && peek() != '=' &&
         peek() != '>' && peek() != '/')
    ++position_;
  return std::string_view(file_.bytes).substr(begin, position_ - begin);
}

bool XmlTags::next(XmlTag& tag) {
  const std::string& bytes = file_.bytes;
  for (;;) {
    const std::size_t open = bytes.find('<', position_);
    if (open == bytes.npos) return false;
    const bool comment = bytes.compare(open, 4, "<!--") == 0;
    if (!comment && bytes.compare(open, 2, "<?") != 0 && bytes.compare(open, 2, "<!") != 0) {
      position_ = open;
      break;
    }
    const std::size_t close = bytes.find(comment ? "-->" : ">", open);
    if (close == bytes.npos) failAt(file_, open, "a comment or declaration does not end");
    position_ = close + 1;
  }
  tag = {};
  tag.begin = position_++;
  tag.closing = peek() == '/';
  if (tag.closing) ++position_;
  tag.name = word();
  if (tag.name.empty()) failAt(file_, tag.begin, "is no XML: a tag has no name");
  readAttributes(tag);
  tag.end = position_;
  return true;
}

void XmlTags::readAttributes(XmlTag& tag) {
  const std::string& bytes = file_.bytes;
  for (;;) {
    skipSpace();
    if (position_ >= bytes.size()) failAt(file_, tag.begin, "the file ends within a tag");
    if (peek() == '/' || peek() == '>') {
      tag.complete = peek() == '/';
      if (tag.complete) ++position_;
      if (peek() != '>') failAt(file_, tag.begin, "is no XML: a tag does not end with '>'");
      ++position_;
      return;
    }
    const std::string_view name = word();
    skipSpace();
    if (name.empty() || peek() != '=') failAt(file_, tag.begin, "an attribute has no value");
    ++position_;
    skipSpace();
    const char quote = peek();
    const std::size_t close =
        quote == '"' || quote == '\'' ? bytes.find(quote, position_ + 1) : bytes.npos;
    if (close == bytes.npos) failAt(file_, tag.begin, "an attribute's value is not in quotes");
    tag.attributes.emplace_back(
        name, resolved(std::string_view(bytes).substr(position_ + 1, close - position_ - 1)));
    position_ = close + 1;
  }
}

}  // namespace innermap
