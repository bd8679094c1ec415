#pragma once
/// \file
/// Parts of pages that open offline: the style, and texts and files in a form that can stand inside a page.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace twincell::analysis {

/// The style sheet of the program's pages (page.css).
std::string_view page_style();

/// `text` escaped for HTML, with names such as s_b and q6 set as symbols with a subscript.
std::string typeset(const std::string& text);

/// A script as the content of a script element, which a "</script" inside it does not end.
std::string script_text(std::string_view script);

/// A document as the content of an element <script type="application/json">. No text in it, such as the name
/// of a file, ends the element or opens another.
std::string json_script_text(const nlohmann::json& document);

/// A file as the value of src or href (RFC 2397).
/// \param type media type, as "image/png"
std::string data_uri(const std::string& type, std::string_view bytes);

}  // namespace twincell::analysis
