// tools/studio/server.h - HTTP of the studio: who may ask (host, origin, cookie), how much, and which of the studio's
// functions answers. docs/security.md has the rules.
#pragma once

#include <memory>
#include <string>

#include "tools/studio/studio.h"

namespace burin {

class StudioServer {
 public:
  /// Listens on 127.0.0.1 at `port` (0: any free one), and for phones on the address `lan` of this machine, if it is
  /// not empty. Throws Error if an address cannot be used.
  StudioServer(Studio& studio, int port, const std::string& lan);
  /// Ends all requests and threads.
  ~StudioServer();
  StudioServer(const StudioServer&) = delete;
  StudioServer& operator=(const StudioServer&) = delete;

  /// "http://127.0.0.1:4321/?token=...": admits one browser. A new one is made when it is used.
  std::string address() const;
  /// The phones' address. Its token serves until the server ends; empty without `lan`.
  std::string phone_address() const;

 private:
  struct Doors;
  std::unique_ptr<Doors> doors_;
};

/// The first IPv4 address of this machine in a local network; empty if there is none.
std::string local_network_address();

/// A QR code as SVG.
std::string qr_svg(const std::string& text);

}  // namespace burin
