#include "mqtt/tls_context.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <array>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "mqtt/tls_failure.h"

namespace etcm::port {

namespace {

// The reason that OpenSSL gives for what has just failed.
std::string last_reason() {
  const unsigned long error = ERR_peek_last_error();
  ERR_clear_error();
  if (ERR_SYSTEM_ERROR(error)) return std::string(": ") + std::strerror(ERR_GET_REASON(error));
  const char* const reason = ERR_reason_error_string(error);
  return reason == nullptr ? std::string() : std::string(" (") + reason + ")";
}

[[noreturn]] void refuse(const std::string& path, const std::string& what) {
  throw std::runtime_error(path + what);
}

// OpenSSL asks for the key that both sides know.
unsigned int give_psk(SSL* ssl, const char*, char* identity, unsigned int identity_max,
                      unsigned char* psk, unsigned int psk_max) {
  const auto& options = *static_cast<const TlsOptions*>(SSL_CTX_get_app_data(SSL_get_SSL_CTX(ssl)));
  const std::size_t bytes = options.psk.size() / 2;
  if (options.psk_identity.size() >= identity_max || bytes > psk_max) return 0;
  std::snprintf(identity, identity_max, "%s", options.psk_identity.c_str());
  for (std::size_t i = 0; i < bytes; ++i) {
    const char* const digits = options.psk.data() + 2 * i;
    std::from_chars(digits, digits + 2, psk[i], 16);
  }
  return static_cast<unsigned int>(bytes);
}

}  // namespace

void TlsContext::Free::operator()(ssl_ctx_st* context) const { SSL_CTX_free(context); }

TlsContext::TlsContext(const TlsOptions& options)
    : options_(options), context_(SSL_CTX_new(TLS_client_method())) {
  // OpenSSL writes to a socket that the other side has closed as to any other.
  std::signal(SIGPIPE, SIG_IGN);
  if (!context_) throw std::runtime_error("TLS cannot be had" + last_reason());
  SSL_CTX_set_min_proto_version(context_.get(), TLS1_2_VERSION);
  // What waits to be written moves to the front of its buffer.
  SSL_CTX_set_mode(context_.get(), SSL_MODE_ENABLE_PARTIAL_WRITE |
                                       SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER |
                                       SSL_MODE_RELEASE_BUFFERS);
  SSL_CTX_set_options(context_.get(), SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION);
  SSL_CTX_set_session_cache_mode(context_.get(), SSL_SESS_CACHE_OFF);
  if (options_.psk.empty()) {
    use_certificates();
  } else {
    use_key();
  }
}

TlsContext::~TlsContext() = default;

void TlsContext::use_certificates() {
  SSL_CTX_set_verify(context_.get(), SSL_VERIFY_PEER, check_certificate);
  if (SSL_CTX_load_verify_file(context_.get(), options_.ca.c_str()) != 1) {
    refuse(options_.ca, last_reason() +
                            "; tls_ca must be a file in PEM with the certificate of the CA, "
                            "which begins with -----BEGIN CERTIFICATE-----");
  }
  if (options_.certificate.empty()) return;
  if (SSL_CTX_use_certificate_chain_file(context_.get(), options_.certificate.c_str()) != 1) {
    refuse(options_.certificate,
           last_reason() +
               "; tls_certificate must be a file in PEM with the gateway's certificate, "
               "and behind it those between it and its CA");
  }
  // A key with a password would have it asked for, where nobody answers.
  SSL_CTX_set_default_passwd_cb(context_.get(), [](char*, int, int, void*) { return 0; });
  if (SSL_CTX_use_PrivateKey_file(context_.get(), options_.key.c_str(), SSL_FILETYPE_PEM) != 1 ||
      SSL_CTX_check_private_key(context_.get()) != 1) {
    refuse(options_.key, last_reason() +
                             "; tls_key must be a file in PEM with the key of tls_certificate, "
                             "without a password, that the gateway may read");
  }
}

// With certificates out of the game. In TLS 1.3 such a key is another thing, which many brokers
// cannot do.
void TlsContext::use_key() {
  SSL_CTX_set_max_proto_version(context_.get(), TLS1_2_VERSION);
  if (SSL_CTX_set_cipher_list(context_.get(), "kECDHEPSK:kDHEPSK:kPSK:!eNULL") != 1) {
    throw std::runtime_error("this OpenSSL has no ciphers for psk_file; use certificates" +
                             last_reason());
  }
  SSL_CTX_set_app_data(context_.get(), const_cast<TlsOptions*>(&options_));
  SSL_CTX_set_psk_client_callback(context_.get(), give_psk);
}

std::string TlsContext::own_name() const {
  if (!options_.psk.empty()) return options_.psk_identity;
  const X509* const certificate = SSL_CTX_get0_certificate(context_.get());
  if (certificate == nullptr) return {};
  std::array<char, 256> name{};
  const int length = X509_NAME_get_text_by_NID(X509_get_subject_name(certificate), NID_commonName,
                                               name.data(), static_cast<int>(name.size()));
  return length > 0 ? std::string(name.data()) : std::string();
}

}  // namespace etcm::port
