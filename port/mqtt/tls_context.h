// What a program shows and believes when it talks TLS: read once, at the start.
#pragma once

#include <memory>
#include <string>

struct ssl_ctx_st;

namespace etcm::port {

// Either certificates or a key that both sides know.
struct TlsOptions {
  std::string ca;  // a file with the certificates of those who may vouch for the other side
  std::string certificate;  // a file with our own and those between it and its CA; empty: none
  std::string key;          // the file of its key
  std::string psk_identity;
  std::string psk;  // hexadecimal; not empty: in place of all certificates
};

class TlsContext {
 public:
  // Throws std::runtime_error: the file, what is wrong with it, and the cure.
  explicit TlsContext(const TlsOptions& options);
  ~TlsContext();
  TlsContext(const TlsContext&) = delete;
  TlsContext& operator=(const TlsContext&) = delete;

  ssl_ctx_st* get() const { return context_.get(); }
  const TlsOptions& options() const { return options_; }
  // By which the other side knows this one: in its certificate (CN), or of its key. Empty: none.
  std::string own_name() const;

 private:
  struct Free {
    void operator()(ssl_ctx_st* context) const;
  };

  void use_certificates();
  void use_key();

  const TlsOptions options_;
  std::unique_ptr<ssl_ctx_st, Free> context_;
};

}  // namespace etcm::port
