assert(time() == 0)
print(energy())
-- expect: :2: energy: only in callbacks and at the end of a run
