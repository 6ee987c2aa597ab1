"""Where the method fails: maps of each limit with its documented rule, and whether the guards see what is beyond."""
