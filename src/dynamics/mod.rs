//! Force-field dynamics of strands (Song, Wu 2012): chains of particles that fall, blow and come to rest.
