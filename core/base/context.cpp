// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/context.h"

#include <algorithm>

#include "base/error.h"

namespace formwright {

Context::Context() : Context(Host{}) {}

Context::Context(Host host)
    : host_(std::move(host)), start_(Clock::now()), last_message_(start_ - std::chrono::hours(1)) {}

bool Context::cancelled() const { return host_.cancel_requested && host_.cancel_requested(); }

void Context::check_cancelled() const {
  if (cancelled()) throw Error(ErrorCode::cancelled, "", "Cancelled.");
}

void Context::progress(double fraction) { progress(fraction, stage_); }

void Context::progress(double fraction, const std::string& stage) {
  check_cancelled();
  // In a span without width there is nothing to report, neither fraction nor stage.
  if (!host_.on_progress || !(to_ > from_)) return;
  const auto now = Clock::now();
  const bool new_stage = stage != stage_;
  const double whole = from_ + (to_ - from_) * std::clamp(fraction, 0.0, 1.0);
  reported_ = std::max(reported_, whole);
  if (!new_stage && now - last_message_ < std::chrono::milliseconds(50)) return;
  stage_ = stage;
  last_message_ = now;
  host_.on_progress({reported_, stage_, std::nullopt});
}

Context::Span::Span(Context& context, double from, double to)
    : context_(context), outer_from_(context.from_), outer_to_(context.to_) {
  const double width = outer_to_ - outer_from_;
  context_.from_ = outer_from_ + width * from;
  context_.to_ = outer_from_ + width * to;
}

Context::Span::~Span() {
  context_.from_ = outer_from_;
  context_.to_ = outer_to_;
}

Context::Span Context::span(double from, double to, const std::string& stage) {
  if (to > from) progress(from, stage);
  return Span(*this, from, to);
}

std::optional<Bytes> Context::find_result(const std::string& key) const {
  return host_.find_result ? host_.find_result(key) : std::nullopt;
}

void Context::keep_result(const std::string& key, const Bytes& result) const {
  if (host_.keep_result) host_.keep_result(key, result);
}

void Context::make_results(const std::vector<ResultTask>& tasks, const std::string& stage) {
  if (!host_.make_results || tasks.empty()) return;
  host_.make_results(tasks, [&](double fraction) { progress(fraction, stage); });
}

double Context::peak_memory_mb() const { return host_.peak_memory_mb ? host_.peak_memory_mb() : 0.0; }

bool Context::claim_result(const std::string& key) const { return !host_.claim_result || host_.claim_result(key); }

void Context::release_result(const std::string& key) const {
  if (host_.release_result) host_.release_result(key);
}

}  // namespace formwright
