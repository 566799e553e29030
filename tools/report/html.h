// tools/report/html.h - the pieces a page is made of: text, numbers, tables, what is folded, and the page around them.
// Nothing refers to anything outside the page; style and script are tools/report/page.css and page.js. Pictures are
// made in tools/report/pictures.h, curves in tools/report/chart.h.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "burin/base/finding.h"

namespace burin {

/// Text as HTML: & < > " escaped.
std::string html(std::string_view text);

/// HTML as text: without tags, entities turned back.
std::string plain_text(const std::string& html);

/// Text as HTML that is not broken into two lines.
std::string unbroken(std::string_view text);

/// A number with its uncertainty in digits that mean something: "0.0602 ± 0.0004"; without, four digits. Never an
/// exponent; what is not finite is "unknown".
std::string with_sigma(double value, double sigma);
std::string number(double value);

/// "23.8 dB"; "no difference" for an infinite one, "unknown" for none.
std::string decibels(double value);

/// "1 view", "3 views"; thousands are parted as people write them: "29,798 scratches".
std::string grouped(long long count, const std::string& what);
std::string grouped(long long count);

/// A table; cells are HTML. The first column is the row's name. Where there is no room, each row becomes a card, and
/// the header's words stand before its cells.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};
std::string table(const Table& table);

/// Closed until it is asked for: its name, what is in it in a few words (HTML), and that.
std::string folded(const std::string& name_html, const std::string& summary_html, const std::string& inside_html);

/// Parts that are folded, one below the other.
std::string folds(const std::string& parts_html);

/// What a person should know as cards, the worst first; the many behind the first few are folded.
std::string cards(std::vector<Finding> findings);

/// A page: what came out and what to do next, pictures, what to mind, and all the rest. HTML but for the title.
struct Page {
  std::string title, outcome;
  std::string next{};                  ///< what to do next, half a sentence; empty: nothing
  std::string next_word{"Next"};       ///< what stands before it
  std::string pictures{};              ///< what is looked at first; below it what to mind
  std::vector<Finding> findings{};     ///< errors stand above the pictures
  std::string body{};                  ///< all the rest
  std::vector<std::string> scripts{};  ///< JavaScript that the body needs, besides page.js
  std::vector<std::string> styles{};   ///< CSS that the body needs, besides page.css
};

/// The whole file, under a policy that lets it load and run nothing but what is in it.
std::string page(const Page& page);

}  // namespace burin
