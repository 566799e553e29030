#include "tools/report/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "burin/base/files/decimals.h"
#include "burin/base/files/svg.h"
#include "embedded/report_files.h"
#include "tools/content_policy.h"
#include "tools/local_time.h"
#include "tools/version.h"

namespace burin {
namespace {

constexpr std::size_t kMostCards = 6;  // more are hard to read

std::string begun_with_capital(std::string text) {
  if (!text.empty() && text.front() >= 'a' && text.front() <= 'z') text.front() = static_cast<char>(text.front() - 32);
  return text;
}

// Turns a finding's half sentence into a sentence.
std::string whole_sentence(std::string text) {
  text = begun_with_capital(std::move(text));
  return text.ends_with('.') || text.ends_with('?') ? text : text + ".";
}

std::string card(const Finding& finding) {
  const std::string severity = in_words(finding.severity);
  std::string where;
  if (!finding.file.empty()) where = " · " + html(finding.file.filename().string());
  std::string out = fmt::format("<li class=\"card {}\"><span class=\"kind\">{}{}</span><p>{}</p>", severity,
                                begun_with_capital(severity), where, html(whole_sentence(finding.what)));
  if (!finding.remedy.empty()) out += fmt::format("<p class=\"remedy\">{}</p>", html(whole_sentence(finding.remedy)));
  return out + "</li>\n";
}

std::string elements(const std::vector<std::string>& texts, const std::string& name) {
  std::string out;
  for (const std::string& text : texts) out += fmt::format("<{0}>{1}</{0}>\n", name, text);
  return out;
}

}  // namespace

std::string html(std::string_view text) { return xml_text(text); }

std::string unbroken(std::string_view text) { return "<span class=\"unbroken\">" + html(text) + "</span>"; }

std::string plain_text(const std::string& text) {
  std::string out;
  bool in_tag = false;
  for (const char c : text) {
    if (c == '<') in_tag = true;
    if (!in_tag) out += c;
    if (c == '>') in_tag = false;
  }
  for (const auto& [from, to] : {std::pair{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&amp;", "&"}})
    for (std::size_t at = 0; (at = out.find(from, at)) != std::string::npos;) {
      out.replace(at, std::string(from).size(), to);
      ++at;
    }
  return out;
}

std::string with_sigma(double value, double sigma) {
  if (!(sigma > 0) || !std::isfinite(sigma) || !std::isfinite(value)) return number(value);
  // Two digits of the uncertainty, and the value to the same digit.
  const int digits = std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, 9);
  return fixed(value, digits) + " ± " + fixed(sigma, digits);
}

std::string number(double value) { return std::isfinite(value) ? significant(value, 4) : "unknown"; }

std::string decibels(double value) {
  return std::isfinite(value) ? fixed(value, 1) + " dB" : value > 0 ? "no difference" : "unknown";
}

std::string grouped(long long count) {
  std::string out = std::to_string(count);
  const std::size_t sign = count < 0 ? 1 : 0;
  for (std::size_t at = out.size(); at > sign + 3;) out.insert(at -= 3, ",");
  return out;
}

std::string grouped(long long count, const std::string& what) {
  const std::string plain = counted(static_cast<std::size_t>(count), what);
  return grouped(count) + plain.substr(plain.find(' '));
}

std::string table(const Table& table) {
  std::string out = "<div class=\"scroll\"><table><thead><tr>";
  for (const std::string& cell : table.header) out += "<th scope=\"col\">" + cell + "</th>";
  out += "</tr></thead><tbody>\n";
  for (const auto& row : table.rows) {
    out += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string label = i < table.header.size() ? plain_text(table.header[i]) : "";
      out += (label.empty() ? "<td>" : "<td data-label=\"" + html(label) + "\">") + row[i] + "</td>";
    }
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string folded(const std::string& name, const std::string& summary, const std::string& inside) {
  return fmt::format(
      "<details class=\"fold\"><summary><b>{}</b> <span class=\"soft\">{}</span></summary>\n"
      "<div class=\"inside\">\n{}</div></details>\n",
      name, summary, inside);
}

std::string folds(const std::string& parts) {
  return parts.empty() ? "" : "<div class=\"folds\">\n" + parts + "</div>\n";
}

std::string cards(std::vector<Finding> findings) {
  if (findings.empty()) return "";
  std::stable_sort(findings.begin(), findings.end(),
                   [](const Finding& a, const Finding& b) { return a.severity > b.severity; });
  const auto list = [&](std::size_t begin, std::size_t end) {
    std::string out = "<ul class=\"cards\">\n";
    for (std::size_t i = begin; i < end; ++i) out += card(findings[i]);
    return out + "</ul>\n";
  };
  // Errors are never folded.
  std::size_t first = std::min(kMostCards, findings.size());
  while (first < findings.size() && findings[first].severity == Finding::Severity::error) ++first;
  if (first + 1 >= findings.size()) return list(0, findings.size());
  return list(0, first) + folded(fmt::format("{} more", findings.size() - first), "of the same kinds, less urgent",
                                 list(first, findings.size()));
}

std::string page(const Page& page) {
  std::vector<std::string> scripts{std::string(embedded::report_files("page.js"))},
      styles{std::string(embedded::report_files("page.css"))};
  scripts.insert(scripts.end(), page.scripts.begin(), page.scripts.end());
  styles.insert(styles.end(), page.styles.begin(), page.styles.end());
  std::vector<Finding> errors, others;
  for (const Finding& f : page.findings) (f.severity == Finding::Severity::error ? errors : others).push_back(f);
  std::string inside = cards(errors) + page.pictures;
  if (!others.empty()) inside += "<h2>Warnings and notes</h2>\n" + cards(others);
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">{}\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"generator\" content=\"burin {}\">\n<title>{}</title>\n{}</head>\n"
      "<body><main>\n<h1>{}</h1>\n<p class=\"outcome\">{}</p>\n{}{}{}"
      "<footer>Written by Burin {} on {}. Lengths of boards are in mm, of grooves in µm; ± is "
      "one standard deviation. This page loads nothing from elsewhere.</footer>\n"
      "</main>\n{}</body></html>\n",
      content_policy(scripts, styles), version(), html(page.title), elements(styles, "style"), html(page.title),
      page.outcome, page.next.empty() ? "" : "<p class=\"next\"><b>" + page.next_word + ":</b> " + page.next + "</p>\n",
      inside, page.body, version(), local_time("%Y-%m-%d %H:%M"), elements(scripts, "script"));
}

}  // namespace burin
