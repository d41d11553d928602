#pragma once
/// Web pages that need nothing but themselves.

#include <filesystem>
#include <string>

namespace talus {

/// Text as it must stand in HTML.
std::string escaped(const std::string& text);

/// The beginning of a page, up to its body: title and style. Classes: n (number), d (default, grey), charts (grid of
/// figures), warning, good, badge.
std::string page_head(const std::string& title);

/// An image as a part of the page, with a caption.
std::string embedded_figure(const std::filesystem::path& image, const std::string& caption);

}  // namespace talus
