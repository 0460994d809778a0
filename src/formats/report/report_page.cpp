// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/report/report_page.hpp"

#include "formats/report/page_json.hpp"
#include "formats/report/page_parts.hpp"

namespace nscdd {
namespace page {
namespace {

// Text between tags.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return result;
}

// JSON between the tags of a script. "<", which occurs only in texts, is escaped: "</script>" would end the script.
std::string within_script(const Json& json) {
  std::string result;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace))
    result += c == '<' ? "\\u003c" : std::string(1, c);
  return result;
}

std::string filled(const Json& data, const std::string& title) {
  const auto text_of = [&](std::string_view name) {
    if (name == "title") return escaped(title);
    if (name == "style") return std::string(parts::style);
    if (name == "data") return within_script(data);
    std::string program;
    for (const std::string_view part : parts::program) program += part;
    return program;
  };
  // Placeholders are searched only in the page, not in what replaces them.
  std::string result;
  std::string_view rest = parts::page;
  for (std::size_t open = rest.find("{{"); open != std::string_view::npos; open = rest.find("{{")) {
    const std::size_t close = rest.find("}}", open);
    result += rest.substr(0, open);
    result += text_of(rest.substr(open + 2, close - open - 2));
    rest.remove_prefix(close + 2);
  }
  return result += rest;
}

Json with_origin(const PageOrigin& origin, Json data) {
  Json all{{"origin",
            {{"program", "nscdd " + version()},
             {"name", origin.name},
             {"command_line", origin.command_line},
             {"case", origin.case_text},
             {"libraries", origin.libraries}}}};
  all.update(data);
  return all;
}

}  // namespace

}  // namespace page

std::string packing_page(const Model& model, const PackingReport& report, const PageOrigin& origin) {
  return page::filled(page::with_origin(origin, page::json_of(model, report)), origin.name + ": nscdd report");
}

std::string run_page(const RunReport& report, const PageOrigin& origin) {
  return page::filled(page::with_origin(origin, page::json_of(report)), origin.name + ": nscdd report of a run");
}

}  // namespace nscdd
