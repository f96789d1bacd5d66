#include <memory>
#include <string>

#include <accdec/plot/figure.hpp>
#include <accdec/plot/html_result.hpp>
#include <accdec/plot/plot_result.hpp>

#include "bindings.hpp"

namespace accdec::python {

void bind_figure(py::module_& module) {
  module.def(
      "result_drawing",
      [](const std::shared_ptr<DesignResult>& result, const std::string& corner, const std::string& format) {
        return drawn([&] {
          const Figure figure = plot_result(*result, corner);
          const std::string svg = render_svg(figure);
          return format == "html" ? html_result_page(*result, figure, svg) : convert_svg(svg, format, figure.title);
        });
      },
      py::arg("result"), py::arg("corner"), py::arg("format"));
  module.def("figure_format", &figure_format, py::arg("path"));
}

}  // namespace accdec::python
