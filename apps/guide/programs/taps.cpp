#include <iostream>

#include <accdec/formats/result_json.hpp>
#include <accdec/formats/taps_export.hpp>

int main() {
  std::cout << accdec::export_taps(accdec::read_result("corner.json"), "c");
}
