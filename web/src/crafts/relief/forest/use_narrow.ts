// SPDX-License-Identifier: GPL-3.0-or-later
import { useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { narrow } from '../../../shared/panels/narrow';

/** Whether the window is a phone's, also after it was turned. */
export function useNarrow(): boolean {
  const isNarrow = useSignal(narrow());
  useEffect(() => {
    const measure = () => (isNarrow.value = narrow());
    addEventListener('resize', measure);
    return () => removeEventListener('resize', measure);
  }, []);
  return isNarrow.value;
}
