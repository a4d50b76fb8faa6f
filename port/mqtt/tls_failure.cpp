#include "mqtt/tls_failure.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>

#include <array>
#include <cstdio>
#include <ctime>
#include <memory>

namespace etcm::port {

namespace {

struct FreeNames {
  void operator()(GENERAL_NAMES* names) const { GENERAL_NAMES_free(names); }
};

std::string text_of(const ASN1_STRING* string) {
  const auto* const data = reinterpret_cast<const char*>(ASN1_STRING_get0_data(string));
  std::string text(data, static_cast<std::size_t>(ASN1_STRING_length(string)));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text;
}

std::string common_name(const X509_NAME* name) {
  const int index = X509_NAME_get_index_by_NID(name, NID_commonName, -1);
  if (index < 0) return "nobody";
  return text_of(X509_NAME_ENTRY_get_data(X509_NAME_get_entry(name, index)));
}

std::string address_text(const ASN1_OCTET_STRING* address) {
  const auto* const bytes = ASN1_STRING_get0_data(address);
  const int size = ASN1_STRING_length(address);
  std::array<char, 48> text{};
  if (size == 4) {
    std::snprintf(text.data(), text.size(), "%u.%u.%u.%u", bytes[0], bytes[1], bytes[2], bytes[3]);
  } else if (size == 16) {
    std::size_t at = 0;
    for (int i = 0; i < size; i += 2) {
      at +=
          static_cast<std::size_t>(std::snprintf(text.data() + at, text.size() - at, "%s%x",
                                                 i == 0 ? "" : ":", bytes[i] << 8 | bytes[i + 1]));
    }
  }
  return text.data();
}

// Whom a certificate is for: a few of its names.
std::string names_of(const X509* certificate) {
  constexpr int names_max = 4;
  const std::unique_ptr<GENERAL_NAMES, FreeNames> names(static_cast<GENERAL_NAMES*>(
      X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr)));
  std::string list;
  const int count = names ? sk_GENERAL_NAME_num(names.get()) : 0;
  for (int i = 0; i < count && i < names_max; ++i) {
    const GENERAL_NAME* const name = sk_GENERAL_NAME_value(names.get(), i);
    const std::string text = name->type == GEN_DNS     ? text_of(name->d.dNSName)
                             : name->type == GEN_IPADD ? address_text(name->d.iPAddress)
                                                       : std::string();
    if (!text.empty()) list += (list.empty() ? "" : ", ") + text;
  }
  return list.empty() ? common_name(X509_get_subject_name(certificate)) : list;
}

std::string day(const tm& time) {
  std::array<char, 24> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M UTC", &time);
  return text.data();
}
std::string day(const ASN1_TIME* time) {
  tm parts{};
  return ASN1_TIME_to_tm(time, &parts) == 1 ? day(parts) : "an unknown day";
}
std::string today() {
  const time_t now = std::time(nullptr);
  tm parts{};
  gmtime_r(&now, &parts);
  return day(parts);
}

std::string explain_certificate(int error, int depth, const X509* certificate,
                                const TlsPeer& peer) {
  const std::string its = depth == 0 ? "its certificate"
                                     : "the certificate of its CA, " +
                                           common_name(X509_get_subject_name(certificate)) + ",";
  switch (error) {
    case X509_V_ERR_CERT_HAS_EXPIRED:
      return its + " has expired, on " + day(X509_get0_notAfter(certificate)) +
             "; renew it at the broker (here it is " + today() +
             ": if that is wrong, set the clock)";
    case X509_V_ERR_CERT_NOT_YET_VALID:
      return its + " is not valid before " + day(X509_get0_notBefore(certificate)) +
             "; here it is " + today() + ": set the clock";
    case X509_V_ERR_HOSTNAME_MISMATCH:
    case X509_V_ERR_IP_ADDRESS_MISMATCH:
      return its + " is for " + names_of(certificate) + ", and not for " + peer.host +
             "; give `broker` a name that is in the certificate, or make one for " + peer.host;
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
    case X509_V_ERR_UNABLE_TO_VERIFY_LEAF_SIGNATURE:
    case X509_V_ERR_DEPTH_ZERO_SELF_SIGNED_CERT:
    case X509_V_ERR_SELF_SIGNED_CERT_IN_CHAIN:
    case X509_V_ERR_CERT_SIGNATURE_FAILURE:
    case X509_V_ERR_INVALID_CA:
      return "no CA of " + peer.options.ca + " has signed its certificate, but " +
             common_name(X509_get_issuer_name(certificate)) +
             " has; put the certificate of that one into tls_ca, if it is to be trusted";
    default:
      return its + " is refused: " + X509_verify_cert_error_string(error) + "; make it anew";
  }
}

// What the other side says by an alert; null: no more than its name.
const char* explain_alert(int alert, bool is_key) {
  switch (alert) {
    case SSL_AD_CERTIFICATE_REQUIRED:
      return "the broker wants a certificate of the gateway; give tls_certificate and tls_key";
    case SSL_AD_UNKNOWN_CA:
      return "the broker does not trust the CA of tls_certificate; have it signed by the broker's";
    case SSL_AD_CERTIFICATE_EXPIRED:
      return "tls_certificate has expired; renew it";
    case SSL_AD_CERTIFICATE_REVOKED:
      return "tls_certificate was revoked; make a new one";
    case SSL_AD_BAD_CERTIFICATE:
    case SSL_AD_CERTIFICATE_UNKNOWN:
    case SSL_AD_UNSUPPORTED_CERTIFICATE:
    case SSL_AD_ACCESS_DENIED:
      return "the broker refuses tls_certificate; its log says why";
    case SSL_AD_UNKNOWN_PSK_IDENTITY:
      return "the broker does not know psk_identity; add it there, or correct it here";
    case SSL_AD_BAD_RECORD_MAC:
    case SSL_AD_DECRYPT_ERROR:
      return is_key ? "the key in psk_file is not the one that the broker has for psk_identity; "
                      "give both the same, such as by the install.sh of its folder once more, and "
                      "restart this"
                    : nullptr;
    case SSL_AD_HANDSHAKE_FAILURE:
      return is_key ? "the broker takes no key (PSK) at this port; give tls_ca in place of "
                      "psk_file, or another port"
                    : "the broker takes no certificates at this port, or wants one of the gateway; "
                      "give tls_certificate and tls_key, psk_file in place of tls_ca, or another "
                      "port";
    case SSL_AD_PROTOCOL_VERSION:
      return "the broker knows no TLS 1.2 or newer; bring it up to date";
    default:
      return nullptr;
  }
}

}  // namespace

int check_certificate(int is_good, x509_store_ctx_st* store) {
  if (is_good == 1) return 1;
  const auto* const ssl = static_cast<const SSL*>(
      X509_STORE_CTX_get_ex_data(store, SSL_get_ex_data_X509_STORE_CTX_idx()));
  auto* const peer = static_cast<TlsPeer*>(SSL_get_app_data(ssl));
  const X509* const certificate = X509_STORE_CTX_get_current_cert(store);
  if (peer != nullptr && certificate != nullptr) {
    peer->why_refused = explain_certificate(
        X509_STORE_CTX_get_error(store), X509_STORE_CTX_get_error_depth(store), certificate, *peer);
  }
  return 0;
}

std::string explain_tls_failure(const TlsPeer& peer) {
  constexpr int alert_base = 1000;  // of OpenSSL's reasons for what the other side says
  const unsigned long error = ERR_peek_error();
  const int reason = ERR_GET_REASON(error);
  ERR_clear_error();
  if (!peer.why_refused.empty()) return peer.why_refused;
  if (ERR_GET_LIB(error) == ERR_LIB_SSL && reason > alert_base) {
    const char* const known = explain_alert(reason - alert_base, !peer.options.psk.empty());
    if (known != nullptr) return known;
  }
  if (reason == SSL_R_WRONG_VERSION_NUMBER || reason == SSL_R_PACKET_LENGTH_TOO_LONG ||
      reason == SSL_R_UNEXPECTED_MESSAGE) {
    return "what answers does not speak TLS; give the port that does (usually 8883), or take the "
           "keys of TLS out";
  }
  const char* const words = ERR_reason_error_string(error);
  return std::string("TLS failed: ") + (words == nullptr ? "no reason given" : words) +
         "; the log of the broker may say more";
}

}  // namespace etcm::port
