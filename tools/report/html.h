// tools/report/html.h - elements of a page: text, numbers, tables, folded parts, and the page itself. No page refers to
// external content; style and script are tools/report/page.css and page.js. tools/report/pictures.h makes pictures and
// tools/report/chart.h makes curves.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "burin/base/finding.h"

namespace burin {

/// Escapes & < > " in text for HTML.
std::string html(std::string_view text);

/// Returns the text of HTML: without tags, with entities decoded.
std::string plain_text(const std::string& html);

/// Escapes text for HTML and prevents line breaks in it.
std::string unbroken(std::string_view text);

/// Formats a number with its significant digits and its sigma: "0.0602 ± 0.0004"; without sigma, four digits. Never
/// uses an exponent; NaN and infinity are "unknown".
std::string with_sigma(double value, double sigma);
std::string number(double value);

/// "23.8 dB"; "no difference" for infinity, "unknown" for NaN.
std::string decibels(double value);

/// "1 view", "3 views"; with thousands separators: "29,798 scratches".
std::string grouped(long long count, const std::string& what);
std::string grouped(long long count);

/// A table with HTML cells. The first column is the row's name. On a narrow page, each row becomes a card, with the
/// header's words before its cells.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};
std::string table(const Table& table);

/// Returns a closed part with its name, a short summary (HTML) and its content.
std::string folded(const std::string& name_html, const std::string& summary_html, const std::string& inside_html);

/// Joins folded parts, one below the other.
std::string folds(const std::string& parts_html);

/// Returns findings as cards, errors first; all but the first few are folded.
std::string cards(std::vector<Finding> findings);

/// A page: outcome and next step, pictures, findings, and all the rest. HTML except for the title.
struct Page {
  std::string title, outcome;
  std::string next{};                  ///< next step, half a sentence; empty: none
  std::string next_word{"Next"};       ///< label of the next step
  std::string pictures{};              ///< the main pictures, above the findings
  std::vector<Finding> findings{};     ///< errors go above the pictures
  std::string body{};                  ///< all the rest
  std::vector<std::string> scripts{};  ///< JavaScript for the body, besides page.js
  std::vector<std::string> styles{};   ///< CSS for the body, besides page.css
};

/// Returns the whole file, under a policy that blocks external content and scripts.
std::string page(const Page& page);

}  // namespace burin
