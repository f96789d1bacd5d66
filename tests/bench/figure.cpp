// figure < FIGURE.json > FIGURE.svg: a figure of one panel, drawn as the program draws its own. The scripts beside this
// file use it by figure.py, which says what the text holds.
#include <exception>
#include <iostream>
#include <string>

#include <nlohmann/json.hpp>

#include <accdec/plot/figure.hpp>

namespace {

using Json = nlohmann::json;

accdec::Scale scale(const Json& json) {
  accdec::Scale scale;
  json.at("label").get_to(scale.label), scale.log = json.value("log", false);
  if (json.contains("range"))
    scale.min = json["range"].at(0).get<double>(), scale.max = json["range"].at(1).get<double>();
  if (json.contains("names")) json["names"].get_to(scale.names);
  return scale;
}

accdec::Series series(const Json& json, int style) {
  accdec::Series series;
  json.at("label").get_to(series.label), json.at("x").get_to(series.x), json.at("y").get_to(series.y);
  series.mark = json.value("line", false) ? accdec::Mark::line : accdec::Mark::points;
  series.style = json.value("style", style);
  return series;
}

std::string drawn(const Json& json) {
  accdec::Panel panel;
  json.at("title").get_to(panel.title), panel.x = scale(json.at("x")), panel.y = scale(json.at("y"));
  for (const Json& one : json.at("series")) panel.series.push_back(series(one, static_cast<int>(panel.series.size())));
  accdec::Figure figure;
  figure.panels = {panel};
  figure.panel_width = 900, figure.panel_height = 420;
  return accdec::render_svg(figure);
}

}  // namespace

int main() {
  try {
    std::cout << drawn(Json::parse(std::cin));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "figure: " << error.what() << "\n";
    return 2;
  }
}
