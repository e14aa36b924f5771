-- From version 2 to 3: how the two detectors of contact agree. In trials from before nothing was compared.
ALTER TABLE trial ADD COLUMN detector_checks INTEGER NOT NULL DEFAULT 0;
ALTER TABLE trial ADD COLUMN detector_disagreements INTEGER NOT NULL DEFAULT 0;
ALTER TABLE trial ADD COLUMN detector_deepest_m REAL;
