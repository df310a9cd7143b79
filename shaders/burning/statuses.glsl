// The status of a node (table 4.1 and section 4.4.3). 2, "processed", is passed within a tick.
const int INACTIVE = -1; // split: its children are in use
const int UNUSED = 0; // "initial": an ancestor is in use
const int ACTIVE = 1; // in use: a leaf
