#include "firmware/gateway/fleet_difference.h"

namespace etcm::firmware {

namespace {

std::string count_of_nodes(std::uint32_t count) {
  return std::to_string(count) + (count == 1 ? " node" : " nodes");
}

std::string difference_of_nodes(const PeerReport& peer, const OwnStand& own) {
  const std::uint32_t theirs = peer.merged_count;
  if (theirs == own.known_count) {
    return "it knows other nodes or places than this one; if that stays so, look at its page";
  }
  const std::string counts =
      "it knows " + count_of_nodes(theirs) + ", this one " + std::to_string(own.known_count) + "; ";
  if (theirs > own.known_count && !own.lack.empty()) return counts + std::string(own.lack);
  if (theirs < own.known_count) {
    return counts +
           "if that stays so, its room is too small (vertices_max in [mesh] there), or the broker "
           "drops what it should have: look at its page";
  }
  return counts +
         "if that stays so, the broker drops what this one should have (Mosquitto: "
         "max_queued_messages 0)";
}

std::string number_text(const SiteVersion& site) {
  return site.number == 0 ? "none" : "number " + std::to_string(site.number);
}

std::string difference_of_sites(const PeerReport& peer, const OwnStand& own) {
  if (peer.site.number == own.site.number) {
    const std::string numbers =
        "it goes by another site document of the number " + std::to_string(own.site.number) + "; ";
    if (own.is_site_refused) return numbers + std::string(own.site_trouble);
    return numbers + "if that stays so, reload the gateway with the site file";
  }
  const std::string theirs =
      peer.site.number == 0 ? "no site document" : "site document " + number_text(peer.site);
  const std::string numbers =
      "it goes by " + theirs + ", this one by " + number_text(own.site) + "; ";
  if (peer.site < own.site) {
    if (own.is_site_refused) return numbers + std::string(own.site_trouble);
    return numbers + "it has not got that yet, or has refused it: its page says why";
  }
  if (!own.site_trouble.empty()) return numbers + std::string(own.site_trouble);
  return numbers +
         "it has not come here yet; if that stays so, the broker does not take it from '" +
         peer.name + "': take the site out there, or let it write that, as its page says";
}

// Of as many nodes and the same site.
std::string difference_of_meshes(const PeerReport& peer, const OwnStand& own) {
  if (!own.is_shared) {
    return "this gateway has its own nodes alone in its mesh; set share = \"site\" in [mqtt] here "
           "for the mesh of all";
  }
  const std::uint32_t theirs = peer.mesh_nodes.value_or(own.mesh_nodes);
  if (theirs < own.mesh_nodes && theirs <= peer.node_count) {
    return "its mesh has its own nodes alone, " + std::to_string(theirs) + " of " +
           std::to_string(own.mesh_nodes) +
           "; set share = \"site\" in [mqtt] there for the mesh of all";
  }
  const std::string counts = "its mesh has " + count_of_nodes(theirs) + ", this one's " +
                             std::to_string(own.mesh_nodes) + "; ";
  if (theirs < own.mesh_nodes) {
    return counts +
           "it refuses the others, most often for want of vertices_max in [mesh] there: look at "
           "its page";
  }
  if (!own.lack.empty()) {
    return (theirs == own.mesh_nodes ? "it has another mesh of the same nodes; " : counts) +
           std::string(own.lack);
  }
  if (theirs > own.mesh_nodes) {
    return counts + "this gateway refuses the others: its page says why under `In quarantine`";
  }
  if (peer.version != own.version) {
    return "its program is of version " + (peer.version.empty() ? "unknown" : peer.version) +
           ", this one's of version " + std::string(own.version) + "; install one version on both";
  }
  return "it has the same nodes and the same site, and another mesh of them; look at its page for "
         "features that it refuses, most often for want of features_max or vertices_max in [mesh] "
         "there";
}

}  // namespace

// Places come late: where nodes move all the time, those that two know are never the same.
FleetDifference difference_between(const PeerReport& peer, const OwnStand& own) {
  using Of = FleetDifference::Kind;
  if (peer.merged_count != own.known_count) {
    return {Of::node_counts, {own.known_count, 0}, {peer.merged_count, 0}};
  }
  if (peer.site != own.site) {
    return {Of::sites, {own.site.number, own.site.hash}, {peer.site.number, peer.site.hash}};
  }
  if (peer.mesh_nodes && *peer.mesh_nodes != own.mesh_nodes) {
    return {Of::mesh_nodes, {own.mesh_nodes, 0}, {*peer.mesh_nodes, 0}};
  }
  const Of kind = peer.merged_hash != own.known_hash ? Of::places : Of::meshes;
  return {kind, {own.known_hash, own.mesh_hash}, {peer.merged_hash, peer.mesh_hash}};
}

std::string difference_of(const PeerReport& peer, const OwnStand& own) {
  switch (difference_between(peer, own).kind) {
    case FleetDifference::Kind::node_counts:
    case FleetDifference::Kind::places:
      return difference_of_nodes(peer, own);
    case FleetDifference::Kind::sites:
      return difference_of_sites(peer, own);
    case FleetDifference::Kind::mesh_nodes:
    case FleetDifference::Kind::meshes:
      break;
  }
  return difference_of_meshes(peer, own);
}

bool LastingDifferences::last(const PeerReport& peer, const OwnStand& own, port::Instant now) {
  const FleetDifference difference = difference_between(peer, own);
  const auto [known, is_new] = since_.try_emplace(peer.name, Since{difference, now});
  if (!is_new && known->second.difference != difference) known->second = {difference, now};
  return now - known->second.at >= patience_;
}

}  // namespace etcm::firmware
