#include <iostream>

#include <accdec/design/verify_result.hpp>
#include <accdec/formats/result_json.hpp>

int main() {
  const accdec::ResultCheck check = accdec::verify_result(accdec::read_result("corner.json"));
  std::cout << (check.accepted ? "accepted" : "rejected") << "; proof: " << check.proof << '\n';
}
