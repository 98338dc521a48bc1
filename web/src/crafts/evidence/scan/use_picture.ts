// SPDX-License-Identifier: GPL-3.0-or-later
// A picture of the project's as an address that an image can show.
import { useEffect, useState } from 'preact/hooks';

/** The address of a picture while it is shown. */
export function usePicture(read: () => Promise<Blob | null>, key: string): string | null {
  const [url, setUrl] = useState<string | null>(null);
  useEffect(() => {
    let made: string | null = null;
    let gone = false;
    read().then(
      (blob) => {
        if (blob === null || gone) return;
        made = URL.createObjectURL(blob);
        setUrl(made);
      },
      () => undefined,
    );
    return () => {
      gone = true;
      setUrl(null);
      if (made) URL.revokeObjectURL(made);
    };
  }, [key]);
  return url;
}
