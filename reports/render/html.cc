#include "reports/render/html.h"

#include <fmt/format.h>

#include <map>
#include <vector>

#include "reports/render/assets.h"
#include "reports/render/page_data.h"

namespace moma::reports {
namespace {

/// "frankie-clutter", or the names of all suites.
std::string title(const Json& page) {
  const std::vector<std::string> suites = suites_of(page);
  return suites.empty() ? page.at("store").at("file").get<std::string>() : fmt::format("{}", fmt::join(suites, ", "));
}

/// The text with each character that `names` has replaced by its name.
std::string with_names(const std::string& text, const std::map<char, std::string_view>& names) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    const auto named = names.find(c);
    out += named == names.end() ? std::string_view(&c, 1) : named->second;
  }
  return out;
}

/// `reach`: what the content security policy lets the page fetch.
std::string document(const std::string& title, const std::string& data, const std::string& reach) {
  std::string out;
  out.reserve(data.size() + page_js().size() + page_css().size() + 4096);
  out += "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>";
  out += escape(title);
  out +=
      " \xe2\x80\x93 moma report</title>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      // The page can reach nothing else, whatever a store holds.
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
      "style-src 'unsafe-inline'; font-src data:; img-src data: blob:";
  out += reach;
  out += "\">\n<link rel=\"icon\" href=\"data:,\">\n<style>";
  out += page_css();
  out +=
      "</style>\n</head>\n<body>\n<div id=\"app\"><noscript>This page needs JavaScript to draw its figures. The "
      "numbers are also in the store: moma query DB @summary</noscript></div>\n"
      "<script type=\"application/json\" id=\"moma-data\">";
  out += data;
  out += "</script>\n<script>";
  out += page_js();
  out += "</script>\n</body>\n</html>\n";
  return out;
}

}  // namespace

std::string escape(std::string_view text) {
  const std::string valid = Json::parse(dumped(std::string(text))).get<std::string>();
  return with_names(valid, {{'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}, {'\'', "&#39;"}});
}

std::string script_json(const Json& json) {
  return with_names(dumped(json), {{'<', "\\u003c"}});  // neither </script> nor <!-- can begin
}

std::string html(const Json& page) { return document(title(page), script_json(page), ""); }

std::string served_html(const std::string& title) { return document(title, "{}", "; connect-src 'self'"); }

}  // namespace moma::reports
