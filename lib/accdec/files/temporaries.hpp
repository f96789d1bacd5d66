#pragma once

#include <string>

namespace accdec {

/// Opens a new file for writing beside `target`, with a random name that ends in ".part". It is opened exclusively and
/// not through a link, so nobody else owns it. It is noted, so that a signal can remove it. The name also holds the
/// host and the process: the first temporary of a process in a folder removes those that dead processes of its host
/// left there.
/// @param name  receives the temporary's path
/// @return the file descriptor, or -1 with errno set
int open_temporary(const std::string& target, std::string& name);

/// Removes a temporary; does nothing if it is gone.
void remove_temporary(const std::string& name);

/// Removes the temporaries that dead processes of this host left in a folder: once a process and folder.
void remove_remains(const std::string& folder);

/// Removes all temporaries of this process that are there, before it ends.
void remove_temporaries();

/// Renames a temporary to its target. @return whether that worked; otherwise errno says why and the temporary is still
/// there
bool rename_temporary(const std::string& name, const std::string& target);

/// Last words of this process, but none of its children, on standard error when one of the signals below ends it. ""
/// takes them back.
void say_on_signals(const std::string& words);

/// From now on SIGHUP, SIGINT and SIGTERM remove existing temporaries before they end the process. This is for
/// programs: a library must leave signals alone.
void remove_temporaries_on_signals();

}  // namespace accdec
