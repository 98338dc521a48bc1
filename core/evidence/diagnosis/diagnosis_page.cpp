// SPDX-License-Identifier: GPL-3.0-or-later
// The diagnosis as one HTML file: what was found in words, ranked causes, maps and histograms as inline SVG.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "base/data/xml_text.h"
#include "evidence/diagnosis/diagnosis_report.h"

namespace formwright {
namespace {

/// Large figures in groups of three, small ones with a power of ten, never 2.7e+06.
std::string figure(double value, int digits = 3) {
  char text[40];
  const double size = std::abs(value);
  if (size >= std::pow(10, digits) && size < 1e15) {
    const double unit = std::pow(10, std::floor(std::log10(size)) - digits + 1);
    std::snprintf(text, sizeof text, "%.0f", std::round(size / unit) * unit);
    std::string grouped(text);
    for (auto at = static_cast<std::ptrdiff_t>(grouped.size()) - 3; at > 0; at -= 3)
      grouped.insert(static_cast<std::size_t>(at), "\u2009");
    return (value < 0 ? "\u2212" : "") + grouped;
  }
  if (size > 0 && size < 1e-3) {
    const double power = std::floor(std::log10(size));
    std::snprintf(text, sizeof text, "%.*g\u2009\u00b7\u200910\u207b", digits, size / std::pow(10, power));
    std::string result = (value < 0 ? "\u2212" : "") + std::string(text);
    static constexpr const char* raised[] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                             "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
    for (const char digit : std::to_string(static_cast<int>(-power))) result += raised[digit - '0'];
    return result;
  }
  std::snprintf(text, sizeof text, "%.*g", digits, size);
  return (value < 0 ? "\u2212" : "") + std::string(text);
}

std::string percent_html(double share) {
  if (share > 0.99) return "&gt;\u200999\u2009%";
  if (share < 0.01) return "&lt;\u20091\u2009%";
  return std::to_string(static_cast<int>(std::lround(100 * share))) + "\u2009%";
}

/// Shares are said in percent, everything else with its unit.
std::string quantity(double value, const std::string& unit) {
  return unit.empty() ? figure(value, 2) : figure(value, 2) + "\u2009" + xml_attribute(unit);
}

const char* fault_title(FaultOf fault_of) {
  switch (fault_of) {
    case FaultOf::measurement: return "In your measurement:";
    case FaultOf::simulation: return "In our simulation:";
    case FaultOf::machine: break;
  }
  return "At your machine:";
}

constexpr const char* style = R"(<style>
:root{color-scheme:light dark;--ink:#2b2925;--dim:#6b675f;--line:#dcd8d0;--paper:#f6f4f0;--panel:#fff;--blue:#2b62b5;--good:#2f6f48;--warn:#8a5a00}
@media(prefers-color-scheme:dark){:root{--ink:#ece9e3;--dim:#a9a49a;--line:#45423c;--paper:#201f1c;--panel:#2a2825;--blue:#86b0f0;--good:#84c79c;--warn:#e5b45c}}
*{box-sizing:border-box}body{margin:0;background:var(--paper);color:var(--ink);font:15px/1.5 system-ui,sans-serif}
main{max-width:960px;margin:0 auto;padding:24px 16px 64px}h1{font-size:26px;line-height:1.25;margin:8px 0 4px}h2{font-size:18px;margin:32px 0 8px}
p{margin:6px 0}.dim{color:var(--dim)}.panel{background:var(--panel);border:1px solid var(--line);border-radius:10px;padding:16px;margin:12px 0}
.figures{display:grid;grid-template-columns:repeat(auto-fit,minmax(180px,1fr));gap:12px}.figures b{display:block;font-size:22px;font-variant-numeric:tabular-nums}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}th,td{text-align:left;padding:6px 8px;border-bottom:1px solid var(--line);vertical-align:top}
th{font-weight:600;color:var(--dim)}td.n,th.n{text-align:right;white-space:nowrap}.bar{background:var(--line);border-radius:4px;height:8px;min-width:80px}
.bar i{display:block;height:8px;border-radius:4px;background:var(--blue)}.maps{display:grid;grid-template-columns:repeat(auto-fit,minmax(280px,1fr));gap:12px}
svg{width:100%;height:auto;display:block}svg text{fill:var(--dim);font:11px system-ui,sans-serif}.scroll{overflow-x:auto}
</style>)";

/// Cream to dark brown, from 0.
std::string error_colour(double share) {
  static constexpr std::array<std::array<double, 3>, 4> stops{
      {{250, 240, 216}, {222, 165, 92}, {160, 82, 34}, {66, 26, 8}}};
  const double at = std::clamp(share, 0.0, 1.0) * 3;
  const auto i = std::min<std::size_t>(2, static_cast<std::size_t>(at));
  const double t = at - static_cast<double>(i);
  char text[16];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", static_cast<int>(stops[i][0] + t * (stops[i + 1][0] - stops[i][0])),
                static_cast<int>(stops[i][1] + t * (stops[i + 1][1] - stops[i][1])),
                static_cast<int>(stops[i][2] + t * (stops[i + 1][2] - stops[i][2])));
  return text;
}

/// Points over the flat sheet, coloured by error, with arrows of the residual's part in the plane, lengthened.
std::string map(const Measurement& m, const Eigen::MatrixXd& residual, const Eigen::VectorXd& weights, double largest,
                const std::string& title, const std::string& unit) {
  std::string svg = "<figure class=\"panel\" style=\"margin:0\"><figcaption>" + xml_attribute(title) +
                    "</figcaption><svg viewBox=\"-4 -4 308 334\" role=\"img\" aria-label=\"" + xml_attribute(title) +
                    ": errors from 0 to " + figure(largest) + " " + unit +
                    "\"><rect x=\"0\" y=\"0\" width=\"300\" height=\"300\" fill=\"none\" stroke=\"var(--line)\"/>";
  const Eigen::Index stride = std::max<Eigen::Index>(1, residual.rows() / 900);
  char text[200];
  for (Eigen::Index i = 0; i < residual.rows(); i += stride) {
    if (weights[i] <= 0) continue;
    const double x = 300 * m.place(i, 0), y = 300 * (1 - m.place(i, 1));
    if (residual.cols() >= 2) {
      const double lengthened = 18 / std::max(largest, 1e-12);
      std::snprintf(text, sizeof text, "<path d=\"M%.1f %.1fl%.1f %.1f\" stroke=\"var(--dim)\" stroke-width=\".7\"/>",
                    x, y, residual(i, 0) * lengthened, -residual(i, 1) * lengthened);
      svg += text;
    }
    std::snprintf(text, sizeof text, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2.6\" fill=\"%s\"/>", x, y,
                  error_colour(residual.row(i).norm() / std::max(largest, 1e-12)).c_str());
    svg += text;
  }
  for (int k = 0; k < 60; ++k) {
    std::snprintf(text, sizeof text, "<rect x=\"%d\" y=\"308\" width=\"3.2\" height=\"8\" fill=\"%s\"/>", 60 + 3 * k,
                  error_colour(k / 59.0).c_str());
    svg += text;
  }
  svg += "<text x=\"56\" y=\"316\" text-anchor=\"end\">0</text><text x=\"246\" y=\"316\">" + figure(largest) + " " +
         unit + "</text></svg></figure>";
  return svg;
}

std::string histogram(const std::vector<double>& before, const std::vector<double>& after, double largest,
                      double noise_floor, const std::string& unit) {
  constexpr int bins = 30;
  std::array<int, bins> count_before{}, count_after{};
  const auto fill = [&](const std::vector<double>& values, std::array<int, bins>& count) {
    for (const double v : values)
      ++count[static_cast<std::size_t>(std::min(bins - 1, static_cast<int>(v / std::max(largest, 1e-12) * bins)))];
  };
  fill(before, count_before);
  fill(after, count_after);
  const int highest = std::max({1, *std::max_element(count_before.begin(), count_before.end()),
                                *std::max_element(count_after.begin(), count_after.end())});
  std::string svg = "<svg viewBox=\"0 0 640 190\" role=\"img\" aria-label=\"Histogram of errors before and after\">";
  char text[200];
  for (int b = 0; b < bins; ++b) {
    const auto i = static_cast<std::size_t>(b);
    const double x = 20 + 20.0 * b, hb = 140.0 * count_before[i] / highest, ha = 140.0 * count_after[i] / highest;
    std::snprintf(
        text, sizeof text,
        "<rect x=\"%.1f\" y=\"%.1f\" width=\"9\" height=\"%.1f\" fill=\"#b98a5a\"/><rect x=\"%.1f\" y=\"%.1f\" width=\"9\" height=\"%.1f\" fill=\"var(--blue)\"/>",
        x, 150 - hb, hb, x + 9, 150 - ha, ha);
    svg += text;
  }
  const double floor_x = 20 + 600 * std::min(1.0, noise_floor / std::max(largest, 1e-12));
  std::snprintf(
      text, sizeof text,
      "<path d=\"M%.1f 6V150\" stroke=\"var(--ink)\" stroke-dasharray=\"4 3\"/><text x=\"%.1f\" y=\"14\">noise</text>",
      floor_x, floor_x + 4);
  svg += text;
  svg +=
      "<path d=\"M20 150H620\" stroke=\"var(--line)\"/><text x=\"20\" y=\"166\">0</text><text x=\"620\" y=\"166\" text-anchor=\"end\">" +
      figure(largest) + " " + unit +
      "</text><rect x=\"20\" y=\"174\" width=\"10\" height=\"10\" fill=\"#b98a5a\"/><text x=\"35\" y=\"183\">calibrated</text><rect x=\"110\" y=\"174\" width=\"10\" height=\"10\" "
      "fill=\"var(--blue)\"/><text x=\"125\" y=\"183\">with the extended model</text></svg>";
  return svg;
}

constexpr double min_listed = 0.01;  // of a probability: what is less is counted together

/// All answers, so that the column adds up to 100 %.
std::string answers_table(const DiagnosisReport& report) {
  std::string html =
      "<h2>What it may be</h2><div class=\"panel scroll\"><table><tr><th>Answer</th><th>Probability</th><th class=\"n\"></th></tr>";
  const auto row = [&](const std::string& label, double probability) {
    html += "<tr><td>" + label + "</td><td><div class=\"bar\"><i style=\"width:" +
            std::to_string(static_cast<int>(std::lround(100 * probability))) + "%\"></i></div></td><td class=\"n\">" +
            percent_html(probability) + "</td></tr>";
  };
  double others = 0;
  for (const Answer& answer : report.diagnosis.answers) {
    if (answer.probability >= min_listed) row(xml_attribute(answer_label(report, answer)), answer.probability);
    else others += answer.probability;
  }
  if (others > 0) row("All other answers", others);
  return html + "</table></div>";
}

bool is_listed(const DiagnosisReport& report, const CauseFinding& finding) {
  const std::vector<int>& verdict = report.diagnosis.verdict;
  return finding.probability >= min_listed || std::find(verdict.begin(), verdict.end(), finding.cause) != verdict.end();
}

/// Of the causes that answers name.
std::string strengths_table(const DiagnosisReport& report) {
  std::string rows;
  for (const CauseFinding& f : report.diagnosis.causes) {
    if (!is_listed(report, f)) continue;
    const Cause& cause = report.model.causes()[static_cast<std::size_t>(f.cause)];
    rows += "<tr><td>" + xml_attribute(cause.label) + "</td><td>" + fault_name(cause.fault_of) +
            "</td><td class=\"n\">" + quantity(f.strength, cause.unit) + "</td><td class=\"n\">" +
            (f.fitted ? figure(f.low, 2) + " to " + figure(f.high, 2) : std::string("not fitted")) + "</td></tr>";
  }
  if (rows.empty()) return "";
  return "<h2>How strong</h2><div class=\"panel scroll\"><table><tr><th>Cause</th><th>Whose</th><th class=\"n\">Strength</th><th class=\"n\">95 % interval</th></tr>" +
         rows + "</table></div>";
}

std::string failed_list(const DiagnosisReport& report) {
  std::string rows;
  const auto row = [&](const std::string& label, const std::string& why) {
    rows += "<tr><td>" + xml_attribute(label) + "</td><td>" + xml_attribute(why) + "</td></tr>";
  };
  std::vector<int> said;
  for (const FailedCheck& f : report.diagnosis.failed) {
    if (f.failure == Failure::behind_failed) continue;
    row(answer_label(report, {f.causes, false, 0}), failure_sentence(f.failure));
    if (f.causes.size() == 1) said.push_back(f.causes.front());
  }
  for (const CauseFinding& f : report.diagnosis.causes)
    if (!is_listed(report, f) && std::find(said.begin(), said.end(), f.cause) == said.end())
      row(report.model.causes()[static_cast<std::size_t>(f.cause)].label, "It fits worse than the answers above.");
  if (rows.empty()) return "";
  return "<details class=\"panel\"><summary>Checked and not needed</summary><table><tr><th>Cause</th><th>Why not</th></tr>" +
         rows + "</table></details>";
}

/// What the simulation was extended by before causes were looked for, and what would make it better still.
std::string simulation_panels(const DiagnosisReport& report) {
  std::string html;
  for (const TriedExtension& t : report.simulation.tried)
    if (t.taken || t.advised)
      html += "<div class=\"panel\"><span class=\"dim\">" + std::string(fault_title(FaultOf::simulation)) +
              "</span> <b>" + xml_attribute(t.extension.label) + "</b><p>" + xml_attribute(t.extension.explanation) +
              (t.taken ? " Included from here on: after calibration the mean error is "
                       : " Not included, since it takes longer. With it and nothing else changed, the mean error is ") +
              quantity(t.error_after_mm, report.unit) + " instead of " + quantity(t.error_before_mm, report.unit) +
              ".</p><p>" + xml_attribute(t.extension.remedy) + "</p></div>";
  return html.empty() ? html : "<h2>What our simulation left out</h2>" + html;
}

/// Quantities other than places: each reading, and what both simulations have there.
std::string other_quantity_tables(const DiagnosisReport& report) {
  constexpr Eigen::Index max_rows = 40;
  const Diagnosis& d = report.diagnosis;
  std::string html;
  std::size_t number = 0;
  for (std::size_t i = 0; i < report.model.measurements().size(); ++i) {
    const Measurement& m = report.model.measurements()[i];
    if (m.is_place()) continue;
    const HeldOutGain& gain = d.held_out_others[number++];
    html += "<h2>" + xml_attribute(m.name) +
            "</h2><div class=\"panel scroll\"><p>Error on held-out data: " + figure(gain.before.mean) + "\u2009" +
            xml_attribute(report.unit) + " calibrated, " + figure(gain.after.mean) + "\u2009" +
            xml_attribute(report.unit) +
            " with the extended model.</p><table><tr><th>Reading</th><th class=\"n\">Measured</th><th "
            "class=\"n\">Calibrated</th><th class=\"n\">With the extended model</th></tr>";
    const auto cell = [&](double value) { return "<td class=\"n\">" + figure(value / m.scale) + "</td>"; };
    for (Eigen::Index row = 0; row < std::min(max_rows, m.measured.rows()); ++row)
      html += "<tr><td>" + std::to_string(row + 1) + "</td>" + cell(m.measured(row, 0)) +
              cell(d.base.predictions[i](row, 0)) + cell(d.extended.predictions[i](row, 0)) + "</tr>";
    html += "</table>";
    if (m.measured.rows() > max_rows)
      html += "<p class=\"dim\">The first " + std::to_string(max_rows) + " of " + std::to_string(m.measured.rows()) +
              " readings.</p>";
    html += "</div>";
  }
  return html;
}

}  // namespace

std::string diagnosis_page(const DiagnosisReport& report) {
  const Diagnosis& d = report.diagnosis;
  const ForwardModel& model = report.model;
  const std::string unit = xml_attribute(report.unit);
  const auto with_unit = [&](double value) { return figure(value) + "\u2009" + unit; };
  std::string names;
  for (const Measurement& m : model.measurements())
    if (m.is_place()) names += (names.empty() ? "" : ", ") + m.name;
  std::string html =
      "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>Diagnosis of " +
      xml_attribute(names) + "</title>" + style + "</head><body><main><p class=\"dim\">Diagnosis of " +
      xml_attribute(names) + "</p><h1>" + xml_attribute(verdict_sentence(report)) + "</h1>";

  html += "<div class=\"panel figures\">";
  const auto big = [&](const std::string& label, const std::string& value, const std::string& note) {
    html += "<div><span class=\"dim\">" + label + "</span><b>" + value + "</b><span class=\"dim\">" + note +
            "</span></div>";
  };
  const HeldOutGain& gain = d.held_out;
  big("Error on held-out data, calibrated", with_unit(gain.before.mean),
      figure(gain.before.low) + " to " + figure(gain.before.high));
  big("with the extended model", with_unit(gain.after.mean), figure(gain.after.low) + " to " + figure(gain.after.high));
  if (report.unseen) {
    big("Unseen object, calibrated", with_unit(report.unseen->before.mean),
        figure(report.unseen->before.low) + " to " + figure(report.unseen->before.high));
    big("with the extended model", with_unit(report.unseen->after.mean),
        figure(report.unseen->after.low) + " to " + figure(report.unseen->after.high));
  }
  big("Noise alone would give", with_unit(d.noise_floor), "mean distance");
  html += "</div>";

  html += simulation_panels(report);
  // Of a cause that does not explain the data nothing is advised.
  if (!d.verdict.empty() && d.reading != Reading::unknown) {
    html += "<h2>What happened, and what to do</h2>";
    for (const int cause : d.verdict) {
      const Cause& c = model.causes()[static_cast<std::size_t>(cause)];
      const auto finding =
          std::find_if(d.causes.begin(), d.causes.end(), [&](const CauseFinding& f) { return f.cause == cause; });
      const std::string words = finding == d.causes.end() ? "" : model.in_words(cause, finding->values);
      html += std::string("<div class=\"panel\"><span class=\"dim\">") + fault_title(c.fault_of) + "</span> <b>" +
              xml_attribute(c.label) + "</b><p>" + xml_attribute(words.empty() ? c.explanation : words) + "</p><p>" +
              xml_attribute(c.remedy) + "</p></div>";
    }
  }
  for (const SeparatedPair& s : report.separations) {
    const auto label = [&](int cause) { return xml_attribute(model.causes()[static_cast<std::size_t>(cause)].label); };
    html += "<div class=\"panel\"><b>Not distinguishable by these data: " + label(s.pair.cause_a) + " and " +
            label(s.pair.cause_b) + "</b><p>" +
            (s.what.empty() ? "None of the usual further measurements would tell them apart." : xml_attribute(s.what)) +
            "</p></div>";
  }
  html += answers_table(report) + strengths_table(report) + failed_list(report);

  const Predictions left = residuals(model, d.base.predictions), left_after = residuals(model, d.extended.predictions);
  std::vector<double> before, after;
  for (std::size_t object = 0; object < left.size(); ++object)
    for (Eigen::Index i = 0; i < left[object].rows(); ++i)
      if (model.measurements()[object].is_place() && d.noise[object].weights[i] > 0)
        before.push_back(left[object].row(i).norm()), after.push_back(left_after[object].row(i).norm());
  std::vector<double> sorted = before;
  std::sort(sorted.begin(), sorted.end());
  const double largest = sorted.empty() ? 1 : std::max(1e-9, sorted[sorted.size() * 98 / 100]);
  html +=
      "<h2>Errors on the sheet</h2><p class=\"dim\">Each point where it was on the flat sheet; lines show which way the measured point lies, lengthened.</p>";
  for (std::size_t object = 0; object < left.size(); ++object) {
    const Measurement& m = model.measurements()[object];
    if (!m.is_place()) continue;
    html += "<div class=\"maps\">" +
            map(m, left[object], d.noise[object].weights, largest, m.name + ", calibrated", unit) +
            map(m, left_after[object], d.noise[object].weights, largest, m.name + ", with the extended model", unit) +
            "</div>";
  }
  html += "<div class=\"panel\">" + histogram(before, after, largest, d.noise_floor, unit) + "</div>";
  html += other_quantity_tables(report);

  html +=
      "<h2>Is there structure beyond noise?</h2><div class=\"panel scroll\"><table><tr><th>Object</th><th class=\"n\">Noise found</th><th class=\"n\">as stated</th><th class=\"n\">Outliers</th><th "
      "class=\"n\">Neighbours agree</th><th class=\"n\">p</th><th class=\"n\">afterwards</th><th class=\"n\">p</th></tr>";
  for (std::size_t i = 0; i < d.noise.size(); ++i)
    html +=
        "<tr><td>" + xml_attribute(model.measurements()[i].name) + "</td><td class=\"n\">" +
        with_unit(d.noise[i].sigma / model.measurements()[i].scale) + "</td><td class=\"n\">" +
        (d.noise[i].stated_sigma > 0 ? with_unit(d.noise[i].stated_sigma / model.measurements()[i].scale) : "\u2013") +
        "</td><td class=\"n\">" + std::to_string(d.noise[i].outliers) + "</td><td class=\"n\">" +
        figure(d.structure_before[i].neighbour_correlation, 2) + "</td><td class=\"n\">" +
        figure(d.structure_before[i].p_value, 2) + "</td><td class=\"n\">" +
        figure(d.structure_after[i].neighbour_correlation, 2) + "</td><td class=\"n\">" +
        figure(d.structure_after[i].p_value, 2) + "</td></tr>";
  html +=
      "</table><p class=\"dim\">Neighbouring points whose errors agree (0: not at all, 1: fully) show that something systematic is left.</p></div>";

  html +=
      "<h2>Material</h2><div class=\"panel scroll\"><table><tr><th>Parameter</th><th class=\"n\">Calibrated</th><th class=\"n\">With the extended model</th></tr>";
  for (const int p : model.base_parameters()) {
    const ModelParameter& parameter = model.parameters()[static_cast<std::size_t>(p)];
    html += "<tr><td>" + xml_attribute(parameter.label) + "</td><td class=\"n\">" +
            quantity(parameter.value(d.base.u[p]), parameter.unit) + "</td><td class=\"n\">" +
            quantity(parameter.value(d.extended.u[p]), parameter.unit) + "</td></tr>";
  }
  html +=
      "</table></div><h2>How it was found</h2><div class=\"panel\"><p>" +
      std::to_string(d.simulations + report.simulation.simulations) +
      " simulations. Every cause was fitted together with the material; explanations are "
      "compared by how well they predict the data for their size, against noise and against structure that no cause makes. The errors above are for data left out of each fit: each "
      "object in 16 blocks, a quarter of them at a time.</p>";
  for (const std::string& note : report.notes) html += "<p>" + xml_attribute(note) + "</p>";
  return html + "</div></main></body></html>\n";
}

}  // namespace formwright
