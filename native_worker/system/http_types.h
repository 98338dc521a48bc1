// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What requests and answers are, for all who make them.
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <string>
#include <variant>

namespace formwright {

namespace beast = boost::beast;
namespace http = boost::beast::http;

using TextResponse = http::response<http::string_body>;
using FileResponse = http::response<http::file_body>;
using Response = std::variant<TextResponse, FileResponse>;
using Head = http::request<http::empty_body>;

inline std::string text_of(boost::core::string_view view) { return {view.data(), view.size()}; }

TextResponse text_response(const Head& head, http::status status, std::string body,
                           const std::string& type = "application/json");
TextResponse error_response(const Head& head, http::status status, const std::string& code, const std::string& where,
                            const std::string& message);

}  // namespace formwright
