#include <iostream>

#include <accdec/design/recheck.hpp>
#include <accdec/formats/result_json.hpp>

int main() {
  const accdec::Recheck check = accdec::recheck(accdec::read_result("corner.json"));
  std::cout << (check.accepted ? "accepted" : "rejected") << "; proof: " << check.proof << '\n';
}
