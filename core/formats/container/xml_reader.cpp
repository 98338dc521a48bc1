// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/container/xml_reader.h"

#include <expat.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <new>
#include <optional>
#include <vector>

#include "formats/shared/text_scan.h"

namespace formwright {
namespace {

// 3MF nests six deep and gives a tag a dozen attributes.
constexpr std::size_t max_depth = 256, max_attributes = 256;

// Expat copies what it is given, so it is given little at once.
constexpr std::size_t min_piece_bytes = 64 << 10, max_piece_bytes = 256 << 10;

constexpr const char* ends_too_early = "its XML ends too early; export it or copy it again.";

std::string_view local(std::string_view name) { return name.substr(name.find(':') + 1); }  // npos + 1 = 0

}  // namespace

/// Expat's parser, and the tags of the piece of text that it has read last.
struct XmlReader::Expat {
  struct Piece {  // of `text`
    std::uint32_t from, bytes;
  };
  struct Attribute {
    Piece name, value;
  };
  struct Event {
    Tag tag;
    Piece name;
    std::size_t at;  // byte at which the tag begins
    std::size_t first_attribute, end_attribute;
  };
  struct Failure {
    std::optional<std::size_t> at;  // byte; none where a line would not help
    std::string sentence;
  };

  const MeshSource& source;
  XML_Parser parser;
  std::size_t fed = 0, piece_bytes = min_piece_bytes;
  std::size_t skipped = 0;  // bytes of comments that it has not been given
  std::size_t open = 0;     // elements
  bool progress = false;    // the piece held a tag or text

  std::vector<Event> events;
  std::size_t current = 0;
  std::vector<Attribute> attributes;
  std::string text;
  std::optional<Failure> failure;  // behind all events
  std::exception_ptr exception;    // none may pass through Expat's own frames

  explicit Expat(const MeshSource& xml) : source(xml), parser(XML_ParserCreate(nullptr)) {
    if (parser == nullptr) throw std::bad_alloc();
    XML_SetUserData(parser, this);
    XML_SetElementHandler(
        parser,
        [](void* self, const char* name, const char** values) { static_cast<Expat*>(self)->start(name, values); },
        [](void* self, const char* name) { static_cast<Expat*>(self)->end(name); });
    XML_SetCharacterDataHandler(parser,
                                [](void* self, const char*, int) { static_cast<Expat*>(self)->progress = true; });
    XML_SetStartDoctypeDeclHandler(parser, [](void* self, const char*, const char*, const char*, int) {
      static_cast<Expat*>(self)->fail("its XML has a document type, which 3MF forbids; export it again.");
    });
  }
  ~Expat() { XML_ParserFree(parser); }
  Expat(const Expat&) = delete;
  Expat& operator=(const Expat&) = delete;

  /// Where the current tag begins, or what it has only a part of.
  std::size_t offset() const { return skipped + static_cast<std::size_t>(XML_GetCurrentByteIndex(parser)); }
  std::string_view view(Piece piece) const { return std::string_view(text).substr(piece.from, piece.bytes); }
  const Event& event() const { return events[current]; }

  /// Gives Expat the next piece of the text; its tags take the place of those before.
  void read_piece();

 private:
  /// What is called by Expat lets no exception through.
  template <class Act>
  void guarded(const Act& act) {
    try {
      act();
    } catch (...) {
      exception = std::current_exception();
      XML_StopParser(parser, XML_FALSE);
    }
  }
  void fail(const char* sentence) {
    guarded([&] { failure = Failure{offset(), sentence}; });
    XML_StopParser(parser, XML_FALSE);
  }
  Piece keep(std::string_view part) {
    text.append(part);
    return {static_cast<std::uint32_t>(text.size() - part.size()), static_cast<std::uint32_t>(part.size())};
  }
  void start(const char* name, const char** values);
  void end(const char* name);
  XML_Status parse_piece();
  Failure failure_of_expat() const;
};

void XmlReader::Expat::start(const char* name, const char** values) {
  progress = true;
  if (++open > max_depth) return fail("its XML is nested more than 256 deep; export it again.");
  guarded([&] {
    Event event{Tag::start, keep(local(name)), offset(), attributes.size(), 0};
    for (; *values != nullptr; values += 2) attributes.push_back({keep(local(values[0])), keep(values[1])});
    event.end_attribute = attributes.size();
    events.push_back(event);
  });
  if (!events.empty() && events.back().end_attribute - events.back().first_attribute > max_attributes) {
    events.pop_back();
    fail("a tag has more than 256 attributes; export it again.");
  }
}

void XmlReader::Expat::end(const char* name) {
  progress = true;
  --open;
  guarded([&] { events.push_back({Tag::end, keep(local(name)), offset(), 0, 0}); });
}

XML_Status XmlReader::Expat::parse_piece() {
  const std::string_view all = source.text();
  const bool unfinished = fed > 0 && !progress;
  piece_bytes = unfinished ? 2 * piece_bytes : min_piece_bytes;
  if (unfinished && all.substr(offset()).starts_with("<!--")) {
    // A comment's text does not matter, however long it is.
    const std::size_t end = all.find("-->", fed - 2);
    if (end == std::string_view::npos) source.refuse(ends_too_early);
    piece_bytes = min_piece_bytes;
    if (end > fed) {
      constexpr std::string_view replacement = " -->";
      skipped += end + 3 - fed - replacement.size();
      fed = end + 3;
      return XML_Parse(parser, replacement.data(), static_cast<int>(replacement.size()), XML_FALSE);
    }
  }
  // Expat keeps an unfinished tag and reads it again with every piece: pieces grow, up to a limit.
  if (piece_bytes > max_piece_bytes)
    source.refuse_line(offset(), "one of its tags is longer than 256 kB; export it again.");
  const std::string_view rest = all.substr(fed);
  std::size_t bytes = std::min(rest.size(), piece_bytes);
  for (int i = 0; i < 3 && bytes < rest.size() && (static_cast<unsigned char>(rest[bytes]) & 0xC0u) == 0x80u; ++i)
    --bytes;  // not within a character
  fed += bytes;
  progress = false;
  return XML_Parse(parser, rest.data(), static_cast<int>(bytes), bytes == rest.size());
}

void XmlReader::Expat::read_piece() {
  events.clear(), attributes.clear(), text.clear();
  const XML_Status status = parse_piece();
  if (exception) std::rethrow_exception(exception);
  if (status == XML_STATUS_ERROR && !failure) failure = failure_of_expat();
}

XmlReader::Expat::Failure XmlReader::Expat::failure_of_expat() const {
  const std::size_t at = offset();
  switch (XML_GetErrorCode(parser)) {
    case XML_ERROR_NO_MEMORY: throw std::bad_alloc();
    case XML_ERROR_NO_ELEMENTS:
    case XML_ERROR_UNCLOSED_TOKEN:
    case XML_ERROR_PARTIAL_CHAR:
    case XML_ERROR_UNCLOSED_CDATA_SECTION: return {{}, ends_too_early};
    case XML_ERROR_UNKNOWN_ENCODING:
    case XML_ERROR_INCORRECT_ENCODING: return {at, "its XML is in an unusual encoding; export it in UTF-8."};
    case XML_ERROR_TAG_MISMATCH: {
      const std::string_view name = source.text().substr(at, 200);
      return {at, "the end of “" + clean_text(name.substr(0, name.find_first_of(" \t\r\n>")), 40) +
                      "” does not match its beginning; export it or copy it again."};
    }
    default: return {at, "its XML is damaged; export it or copy it again."};
  }
}

XmlReader::XmlReader(const MeshSource& source) : source_(source) {
  const std::string_view text = source.text();
  if (text.starts_with("\xfe\xff") || text.starts_with("\xff\xfe"))
    source.refuse("its XML is in UTF-16; export it in UTF-8.");
  if (text.find('<') == std::string_view::npos) source.refuse(ends_too_early);
  expat_ = std::make_unique<Expat>(source);
}

XmlReader::~XmlReader() = default;

bool XmlReader::next() {
  Expat& expat = *expat_;
  const bool begun = !expat.events.empty();
  if (begun && depth_ == 0) return false;  // what comes after the root does not matter
  if (begun) ++expat.current;
  while (expat.current == expat.events.size()) {
    if (expat.failure) {
      if (expat.failure->at) source_.refuse_line(*expat.failure->at, expat.failure->sentence);
      source_.refuse(expat.failure->sentence);
    }
    expat.read_piece();
    expat.current = 0;
  }
  if (tag() == Tag::start) ++depth_;
  else --depth_;
  return true;
}

XmlReader::Tag XmlReader::tag() const { return expat_->event().tag; }
std::string_view XmlReader::name() const { return expat_->view(expat_->event().name); }
void XmlReader::refuse(const std::string& what) const { source_.refuse_line(expat_->event().at, what); }

std::string_view XmlReader::attribute(std::string_view name) const {
  const Expat::Event& event = expat_->event();
  for (std::size_t i = event.first_attribute; i < event.end_attribute; ++i)
    if (const Expat::Attribute& attribute = expat_->attributes[i]; expat_->view(attribute.name) == name)
      return expat_->view(attribute.value);
  return {};
}

bool XmlReader::has(std::string_view name) const {
  const Expat::Event& event = expat_->event();
  for (std::size_t i = event.first_attribute; i < event.end_attribute; ++i)
    if (expat_->view(expat_->attributes[i].name) == name) return true;
  return false;
}

std::string XmlReader::text_attribute(std::string_view name) const { return clean_text(attribute(name), 1000); }

}  // namespace formwright
