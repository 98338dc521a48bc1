// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Drawings made to take memory or time: small files that say much.
#include <functional>
#include <string>

namespace formwright::test {

inline std::string repeated(const std::string& text, std::size_t bytes) {
  std::string result;
  while (result.size() < bytes) result += text;
  return result;
}

inline std::string drawing_of(const std::string& body) {
  return "<svg xmlns='http://www.w3.org/2000/svg' width='100mm' height='60mm' viewBox='0 0 100 60' fill='none' stroke='red'>" +
         body + "</svg>";
}

/// A path whose corners jump to and fro, so that every side crosses nearly every other one.
inline std::string star_path(std::size_t corners) {
  std::string path = "M0 0";
  for (std::size_t i = 0; i < corners; ++i)
    path += "L" + std::to_string(i % 2 == 0 ? 0 : 90) + " " +
            std::to_string(0.05 * static_cast<double>(i * 7919 % 997)).substr(0, 5);
  return path;
}

/// Hands over names and files, of about `bytes` each, one after the other: all of them at once would count as memory.
inline void hostile_drawings(std::size_t bytes,
                             const std::function<void(const std::string& name, const std::string& file)>& take) {
  const auto add = [&](const std::string& name, const std::string& body) { take(name, drawing_of(body)); };
  const auto path = [](const std::string& data) { return "<path d='" + data + "'/>"; };
  add("control points at 1e9", path("M0 0" + repeated("C1e9 1e9-1e9 1e9 1 1", bytes)));
  add("control points at 9e5", path("M0 0" + repeated("C9e5 9e5-9e5 9e5 1 1", bytes)));
  add("control points at 2e4", path("M0 0" + repeated("C2e4 2e4-2e4 2e4 1 1", bytes)));
  add("arcs of 1e5", path("M0 0" + repeated("A9e4 9e4 0 1 1 1 1A9e4 9e4 0 1 1 0 0", bytes)));
  add("short lines", path("M0 0" + repeated("h1v1h-1v-1", bytes)));
  add("short subpaths", path(repeated("M0 0h1", bytes)));
  add("short paths", repeated("<path d='M0 0h1'/>", bytes));
  add("circles", repeated("<circle r='50'/>", bytes));
  add("attributes", "<path d='M0 0h1' " + repeated("a='' ", bytes) + "/>");
  add("deep groups", repeated("<g>", bytes));
  add("closed deep groups", repeated("<g>", bytes / 2) + path("M0 0h1") + repeated("</g>", bytes / 2));
  std::string laughs = "<path id='a0' d='M0 0h1'/>";
  for (int i = 1; i < 60; ++i) {
    const std::string use = "<use href='#a" + std::to_string(i - 1) + "'/>";
    laughs += "<g id='a" + std::to_string(i) + "'>" + use + use + use + use + "</g>";
  }
  add("copies of copies", laughs);
  add("copies of a long path",
      "<path id='p' d='M0 0" + repeated("L1 1", bytes / 2) + "'/>" + repeated("<use href='#p'/>", bytes / 2));
  add("copies of a long empty path",
      "<path id='p' d='" + repeated("M0 0", bytes / 2) + "'/>" + repeated("<use href='#p'/>", bytes / 2));
  add("copies of a long style", "<path id='p' d='M0 0h1' style='" + repeated("a:b;", bytes / 2) + "'/>" +
                                    repeated("<use href='#p'/>", bytes / 2));
  add("copies of a long transform", "<path id='p' d='M0 0h1' transform='" + repeated("rotate(1)", bytes / 2) + "'/>" +
                                        repeated("<use href='#p'/>", bytes / 2));
  add("copies of a long name", "<path d='M0 0h1' id='" + std::string(bytes / 2, 'p') + "'/><g>" +
                                   repeated("<path d='M0 0h1'/>", bytes / 2) + "</g>");
  add("copies of a long switch", "<switch id='p'>" + repeated("<g systemLanguage='x'/>", bytes / 2) + "</switch>" +
                                     repeated("<use href='#p'/>", bytes / 2));
  add("rules", "<style>" + repeated("g{x:1;r:1}", bytes / 2) + "</style>" + repeated("<g/>", bytes / 2));
  add("rules for ancestors", "<style>" + repeated("g g g g g g g b{r:1}", bytes / 2) + "</style>" +
                                 repeated("<g>", 600) + repeated("<b/>", bytes / 2) + repeated("</g>", 600));
  add("selectors", "<style>" + repeated("a,", bytes) + "a{r:1}</style>" + path("M0 0h1"));
  add("declarations", "<style>*{" + repeated("r:1;", bytes) + "}</style>" + repeated(path("M0 0h1"), 5000));
  add("classes", "<style>.a{r:1}</style><path d='M0 0h1' class='" + repeated("a ", bytes) + "'/>");
  add("places", "<style>g:nth-child(3){r:1}</style>" + repeated("<g/>", bytes));
  add("nested media", "<style>" + repeated("@media all{", bytes) + "</style>" + path("M0 0h1"));
  add("names", [&] {
    std::string body;
    for (int i = 0; body.size() < bytes; ++i) body += "<g id='" + std::to_string(i) + "'/>";
    return body;
  }());
  add("dashes of 1e-9", "<path stroke-dasharray='1e-9' d='M0 0h90'/>");
  add("dashes of no length", "<path stroke-dasharray='0 1e-9' d='M0 0h90'/>");
  add("dashes of 1e-300", "<path stroke-dasharray='1e-300' d='M0 0h90'/>");
  add("dashes", "<path stroke-dasharray='0.001' d='M0 0" + repeated("h9h-9", bytes) + "'/>");
  add("dash list", "<path d='M0 0h90' stroke-dasharray='" + repeated("1 ", bytes) + "'/>");
  add("clipped clips", "<clipPath id='c'>" + path(star_path(bytes / 30)) + "</clipPath>" +
                           repeated("<path clip-path='url(#c)' d='M0 0L90 50'/>", bytes / 2));
  add("clipped star", "<clipPath id='c'>" + path(star_path(bytes / 30)) +
                          "</clipPath><g stroke='none' fill='red' clip-path='url(#c)'>" + path(star_path(bytes / 30)) +
                          "</g>");
  add("star clipped by a star", "<clipPath id='c'>" + path(star_path(1000)) +
                                    "</clipPath><g stroke='none' fill='red' clip-path='url(#c)'>" +
                                    path(star_path(1000)) + "</g>");
  add("nested viewports", repeated("<svg>", 200 * 5) + repeated(path("M0 0h1"), bytes) + repeated("</svg>", 200 * 6));
  std::string boxes;
  for (int i = 0; i < 100; ++i) boxes += "<g style='transform-box:fill-box;transform:rotate(1deg)'>";
  add("boxes in boxes", boxes + path("M0 0h1") + repeated("</g>", 400));
  add("clips in clips", [&] {
    std::string body;
    for (int i = 0; i < 80; ++i)
      body += "<clipPath id='c" + std::to_string(i) + "'><rect width='9' height='9' clip-path='url(#c" +
              std::to_string(i + 1) + ")'/><rect width='9' height='9' clip-path='url(#c" + std::to_string(i + 1) +
              ")'/></clipPath>";
    return body + "<path clip-path='url(#c0)' d='M0 0h1'/>";
  }());
  add("a clip of itself",
      "<clipPath id='c'><rect clip-path='url(#c)' width='9' height='9'/></clipPath><path clip-path='url(#c)' d='M0 0h1'/>");
  add("a gradient of itself",
      "<linearGradient id='a' href='#a'/>" + repeated("<path d='M0 0h1' stroke='url(#a)'/>", bytes));
  add("numbers", path("M" + std::string(bytes, '1') + " 1"));
  add("exponents", path("M0 0" + repeated("h1e-999999999", bytes)));
  add("points", "<polygon points='" + repeated("1,1 2,2 ", bytes) + "'/>");
  add("text", "<text>" + std::string(bytes, 'x') + "</text>" + path("M0 0h1"));
  add("comments", "<style>" + repeated("/**/", bytes / 2) + "</style><path d='M0 0h1' style='" +
                      repeated("/**/", bytes / 2) + "'/>");
}

}  // namespace formwright::test
