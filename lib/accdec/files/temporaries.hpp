#pragma once

#include <string>

namespace accdec {

/// A new file beside `target` under a random name that ends in ".part", opened for writing: exclusively, so that it is
/// nobody else's, and not through a link. It is noted, so that a signal can remove it.
/// @param name  receives the temporary's path
/// @return the file descriptor, or -1 with errno set
int open_temporary(const std::string& target, std::string& name);

/// Removes a temporary; does nothing if it is gone.
void remove_temporary(const std::string& name);

/// Renames a temporary to its target. @return whether that worked; otherwise errno says why and the temporary is still
/// there
bool rename_temporary(const std::string& name, const std::string& target);

/// From now on SIGHUP, SIGINT and SIGTERM remove what temporaries there are before they end the process. For programs;
/// a library leaves signals to whom they belong.
void remove_temporaries_on_signals();

}  // namespace accdec
