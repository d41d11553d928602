#pragma once
/// Parts of web pages that need no other files.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace talus {

/// Text escaped for HTML.
std::string escaped(const std::string& text);

/// Bytes as text.
std::string base64(const std::string& bytes);

/// The beginning of a page, up to its body: title and style, and more style. Classes: n (number), d (default, grey),
/// charts (grid of figures), warning, good, badge.
std::string page_head(const std::string& title, std::string_view more_style = {});

/// A script as a part of the page.
std::string embedded_script(std::string_view script);

/// JSON as a part of the page, for its scripts to find by `id`.
std::string embedded_json(const std::string& id, const std::string& json);

/// `n` of `all` numbers from 0, evenly, the first and the last among them.
std::vector<std::size_t> spread_out(std::size_t all, std::size_t n);

/// An image as a part of the page, with a caption.
std::string embedded_figure(const std::filesystem::path& image, const std::string& caption);

}  // namespace talus
