// A small reader of HTML, as strict as XML where HTML is lax: enough to say whether a page of ours is well-formed.
#pragma once

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace iso::test {

struct HtmlElement {
  std::string name;
  std::map<std::string, std::string> attributes;  // as written, not unescaped
  std::string text;                               // up to the next tag, as written
};

struct HtmlPage {
  std::vector<HtmlElement> elements;  // in order
  std::vector<std::string> complaints;

  std::vector<const HtmlElement*> named(std::string_view name) const {
    std::vector<const HtmlElement*> found;
    for (const HtmlElement& e : elements)
      if (e.name == name) found.push_back(&e);
    return found;
  }
};

class HtmlReader {
 public:
  explicit HtmlReader(std::string_view text) : text_(text) {}

  HtmlPage read() {
    while (at_ < text_.size()) text_[at_] == '<' ? tag() : words();
    if (!open_.empty()) complain("not closed: " + open_.back());
    return std::move(page_);
  }

 private:
  void complain(const std::string& what) { page_.complaints.push_back("at byte " + std::to_string(at_) + ": " + what); }
  bool is_void(const std::string& name) const {
    static const std::set<std::string> kVoid{"meta", "img", "input", "br", "hr", "link"};
    return kVoid.count(name) > 0;
  }

  // Text up to the next tag; what is escaped must be one of the five, or a number.
  void words() {
    const std::size_t end = std::min(text_.find('<', at_), text_.size());
    const std::string_view words = text_.substr(at_, end - at_);
    check_escapes(words);
    if (words.find('>') != words.npos) complain("a bare >");
    if (opened_) page_.elements.back().text = words;
    opened_ = false;
    at_ = end;
  }
  void check_escapes(std::string_view words) {
    for (std::size_t i = words.find('&'); i != words.npos; i = words.find('&', i + 1)) {
      bool known = false;
      for (const char* name : {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"}) known = known || words.substr(i).starts_with(name);
      if (!known) complain("a bare &");
    }
  }

  void tag() {
    if (text_.substr(at_).starts_with("<!DOCTYPE html>")) {
      if (at_ != 0) complain("a doctype inside");
      at_ += 15;
      return;
    }
    opened_ = false;
    const bool closing = text_.substr(at_).starts_with("</");
    at_ += closing ? 2 : 1;
    const std::string name = word();
    if (name.empty()) complain("a bare <");
    if (closing) {
      if (open_.empty() || open_.back() != name) complain("</" + name + "> closes " + (open_.empty() ? "nothing" : open_.back()));
      if (!open_.empty()) open_.pop_back();
      if (at_ >= text_.size() || text_[at_++] != '>') complain("</" + name + " without >");
      return;
    }
    open(name);
  }

  void open(const std::string& name) {
    page_.elements.push_back({name, {}, {}});
    while (attribute()) continue;
    const bool ends_itself = text_.substr(at_).starts_with("/>");
    at_ += ends_itself ? 1 : 0;
    if (at_ >= text_.size() || text_[at_++] != '>') complain("<" + name + " without >");
    if (ends_itself || is_void(name)) return;
    opened_ = true;
    open_.push_back(name);
    if (name != "script" && name != "style") return;
    const std::size_t end = text_.find("</" + name, at_);
    page_.elements.back().text = text_.substr(at_, end - at_);
    at_ = std::min(end, text_.size());
  }

  bool attribute() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    const std::string name = word();
    if (name.empty()) return false;
    auto& attributes = page_.elements.back().attributes;
    if (attributes.count(name)) complain("twice: " + name);
    attributes[name] = {};
    if (at_ >= text_.size() || text_[at_] != '=') return true;
    const std::size_t end = text_.find('"', at_ + 2);
    if (at_ + 1 >= text_.size() || text_[at_ + 1] != '"' || end == text_.npos) {
      complain("not quoted: " + name);
      return false;
    }
    attributes[name] = text_.substr(at_ + 2, end - at_ - 2);
    check_escapes(attributes[name]);
    if (attributes[name].find_first_of("<>") != std::string::npos) complain("a bare < or > in " + name);
    if (name == "id" && !ids_.insert(attributes[name]).second) complain("id twice: " + attributes[name]);
    at_ = end + 1;
    return true;
  }

  std::string word() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '-' || text_[at_] == ':')) ++at_;
    return std::string(text_.substr(begin, at_ - begin));
  }

  std::string_view text_;
  std::size_t at_ = 0;
  bool opened_ = false;  // just now, by the tag before
  std::vector<std::string> open_;
  std::set<std::string> ids_;
  HtmlPage page_;
};

inline HtmlPage read_html(std::string_view text) { return HtmlReader(text).read(); }

}  // namespace iso::test
