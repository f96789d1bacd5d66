#include <iostream>

#include <accdec/result.hpp>
#include <accdec/verify.hpp>

int main() {
  const accdec::ResultCheck check = accdec::verify_result(accdec::read_result("corner.json"));
  std::cout << (check.accepted ? "accepted" : "rejected") << "; proof: " << check.proof << '\n';
}
