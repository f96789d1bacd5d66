#include <iostream>

#include <accdec/result.hpp>

int main() {
  std::cout << accdec::export_taps(accdec::read_result("corner.json"), "c");
}
