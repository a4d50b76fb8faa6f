// Why a connection with TLS failed, in a line for who set it up.
#pragma once

#include <string>

#include "mqtt/tls_context.h"

struct x509_store_ctx_st;

namespace etcm::port {

// Whom a connection is to lead to, and what was found out; the application data of its SSL.
struct TlsPeer {
  const TlsOptions& options;
  std::string host;
  std::string why_refused{};  // of its certificate
};

// Called by OpenSSL with each certificate of the other side: notes what is wrong with one.
int check_certificate(int is_good, x509_store_ctx_st* store);

// REQUIRES: the last operation has failed in TLS itself; what OpenSSL has to say of it is taken.
std::string explain_tls_failure(const TlsPeer& peer);

}  // namespace etcm::port
