//! Times in words: durations, and moments in Coordinated Universal Time.

/// A time in seconds, in words.
pub fn duration(seconds: f64) -> String {
    if seconds < 0.95 {
        return format!("{:.0} ms", 1000.0 * seconds);
    }
    if seconds < 59.5 {
        return if seconds < 9.95 { format!("{seconds:.1} s") } else { format!("{seconds:.0} s") };
    }
    let minutes = (seconds / 60.0).round() as u64;
    if minutes < 60 { format!("{minutes} min") } else { format!("{} h {:02} min", minutes / 60, minutes % 60) }
}

/// Milliseconds since 1970 as `2026-11-22 15:04`, in UTC.
pub fn moment(milliseconds: i64) -> String {
    let minutes = milliseconds.div_euclid(60_000);
    let (year, month, day) = date(minutes.div_euclid(1440));
    let minute = minutes.rem_euclid(1440);
    format!("{year:04}-{month:02}-{day:02} {:02}:{:02}", minute / 60, minute % 60)
}

/// Year, month and day of a day counted from 1970-01-01, in the Gregorian calendar. Years are counted from March, so
/// that the day which may be missing is the last one.
fn date(day: i64) -> (i64, i64, i64) {
    const ERA: i64 = 146_097; // days of 400 years
    let from_march_of_0 = day + 719_468;
    let (era, rest) = (from_march_of_0.div_euclid(ERA), from_march_of_0.rem_euclid(ERA));
    let year = (rest - rest / 1460 + rest / 36_524 - rest / (ERA - 1)) / 365;
    let of_year = rest - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    (400 * era + year + i64::from(month <= 2), month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_shown_in_fitting_units() {
        let words = [0.0123, 3.21, 42.4, 600.0, 5430.0].map(duration);
        assert_eq!(words, ["12 ms", "3.2 s", "42 s", "10 min", "1 h 31 min"]);
    }

    #[test]
    fn moments_are_those_of_the_calendar() {
        // date -u -d @SECONDS
        let known = [
            (0, "1970-01-01 00:00"),
            (951_782_399, "2000-02-28 23:59"),
            (951_782_400, "2000-02-29 00:00"),
            (1_709_251_199, "2024-02-29 23:59"),
            (1_795_360_923, "2026-11-22 15:22"),
            (4_107_542_400, "2100-03-01 00:00"),
            (-1, "1969-12-31 23:59"),
        ];
        for (seconds, text) in known {
            assert_eq!(moment(1000 * seconds), text);
        }
    }
}
