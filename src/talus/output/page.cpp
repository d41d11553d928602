#include "talus/output/page.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

namespace talus {

namespace {

std::string contents(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

constexpr const char* style = R"(
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; margin-bottom: .2rem; } h2 { font-size: 1.2rem; margin-top: 2.2rem; border-bottom: 1px solid #ddd; }
table { border-collapse: collapse; } td, th { padding: .15rem .9rem .15rem 0; text-align: left; vertical-align: top; }
td.n { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
tr.d td { color: #777; } figure { margin: 1rem 0; } img { max-width: 100%; height: auto; } figcaption { color: #555; font-size: .9rem; }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(26rem, 1fr)); gap: 1rem; }
.warning { border-left: .3rem solid #d55e00; padding: .3rem .8rem; background: #fdf3ec; margin: .5rem 0; }
.claims td { border-top: 1px solid #eee; } .claims td:first-child { min-width: 18rem; } .claims tr.d td { border: 0; } code, summary { color: #666; font-size: .85rem; }
.badge { border-radius: .6rem; padding: 0 .6rem; color: #fff; font-size: .85rem; white-space: nowrap; }
.yes { background: #00795a; } .part { background: #9a6a00; } .no { background: #b24a00; } .open { background: #666; }
.good { border-left-color: #009e73; background: #eef8f4; } pre { background: #f6f6f6; padding: .8rem; overflow-x: auto; font-size: .85rem; }
)";

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

std::string base64(const std::string& bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve(bytes.size() * 4 / 3 + 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() || k < 2 ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string page_head(const std::string& title, std::string_view more_style) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>{}</title><style>{}{}</style></head><body>\n",
      escaped(title), style, more_style);
}

std::string embedded_script(std::string_view script) { return fmt::format("<script>\n{}</script>\n", script); }

std::string embedded_json(const std::string& id, const std::string& json) {
  std::string safe;  // no text may end the element
  for (char c : json) safe += c == '<' ? "\\u003c" : std::string(1, c);
  return fmt::format("<script type=\"application/json\" id=\"{}\">{}</script>\n", id, safe);
}

std::vector<std::size_t> spread_out(std::size_t all, std::size_t n) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < n; ++i) chosen.push_back(n > 1 ? (i * (all - 1) + (n - 1) / 2) / (n - 1) : 0);
  return chosen;
}

std::string embedded_figure(const std::filesystem::path& image, const std::string& caption) {
  return fmt::format("<figure><img alt=\"{}\" src=\"data:image/{};base64,{}\"><figcaption>{}</figcaption></figure>\n",
                     escaped(caption), image.extension() == ".svg" ? "svg+xml" : "png", base64(contents(image)),
                     escaped(caption));
}

}  // namespace talus
