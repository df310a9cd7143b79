// The exclusive sum of one number a thread over a workgroup of 256, in shared memory.

const uint GROUP = 256u;

shared uint sums[256];

// Adds up `value` of all threads before `thread`; afterwards sums[GROUP - 1] holds the total.
uint sum_before(uint thread, uint value) {
    sums[thread] = value;
    barrier();
    for (uint reach = 1u; reach < GROUP; reach *= 2u) {
        uint before = 0u;
        if (thread >= reach) {
            before = sums[thread - reach];
        }
        barrier();
        sums[thread] += before;
        barrier();
    }
    return sums[thread] - value;
}
