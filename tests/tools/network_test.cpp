// Proves: Burin reaches for no network: none of its own code calls what opens a connection or asks for an address. Of
// cpp-httplib it uses the server alone (`burin studio`), which answers and never asks.
// (Libraries that it stands on are Debian's: docs/security.md says what they are asked for.)
#include <gtest/gtest.h>

#include <regex>

#include "tests/places.h"
#include "tests/tools/program.h"

namespace burin {
namespace {

TEST(Network, NothingOfItIsCalled) {
  const TemporaryFolder folder;
  const Outcome listed = run_shell(folder, "nm --dynamic --undefined-only " + quoted(places::program()));
  if (listed.exit_code != 0) GTEST_SKIP() << "there is no nm (package binutils)";
  ASSERT_NE(listed.out.find(" open"), std::string::npos) << "the list holds what files are opened with";
  const std::regex network(
      R"( (socket|connect|bind|listen|accept4?|sendto|sendmsg|recvfrom|recvmsg|getaddrinfo|gethostby\w+|res_\w+|curl_\w+|SSL_\w+|BIO_new_connect)(@|\n))");
  std::smatch found;
  EXPECT_FALSE(std::regex_search(listed.out, found, network)) << found.str();
  // Names as the compiler writes them: httplib::Client, ClientImpl, SSLClient.
  const std::regex client(R"(7httplib\d+\w*Client)");
  EXPECT_FALSE(std::regex_search(listed.out, found, client)) << found.str();
}

}  // namespace
}  // namespace burin
