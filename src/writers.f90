!> The outputs of a job, and what is written of a motion: at its beginning, at its instants and at its end. The order of
!> the outputs is that of this module; `motion_run` and `variant_runs` know only these procedures.
module writers
   use kinds, only: wp
   use failures, only: status_solved
   use mechanism, only: settings_t, instant, instant_count
   use deck_variants, only: variation_t
   use text_output, only: output_t, put
   use command_line, only: options_t, out_listing, out_csv, out_table, out_log
   use outputs, only: outputs_t
   use listing, only: layout_t, listing_state_t, listing_instant, listing_end, put_untold
   use column_table, only: column_table_t, new_column_table, note_columns, put_columns
   use csv, only: csv_instant, table_t, table_instant
   use solver_log, only: log_instant
   use counts, only: counts_t
   use rows, only: finished_row_t, find_rows
   use set_motion, only: has_words
   use set_analysis, only: set_analysis_t, sample_set, set_certificates, set_closing_diagnostics
   use analysis, only: redundancy_error
   use phrases, only: phrase_t, phrase
   use number_format, only: whole
   implicit none
   private
   public :: writers_t, printing_t, begin_printing, is_next, print_instant, end_tables, print_end, break_off

   !> The job's outputs, and what they keep from set to set.
   type, extends(outputs_t) :: writers_t
      type(options_t) :: options
      integer :: status = status_solved             !< the exit status of what was computed
      integer :: first = 1, last = 0                !< the sets that were read
      type(layout_t) :: layout                      !< of the listing of the set at hand
      type(table_t) :: table                        !< of the set at hand
      logical :: varies = .false.                   !< the deck has VARY cards
      type(variation_t), allocatable :: variations(:)   !< of all sets of the deck; empty without VARY cards
   end type writers_t

   !> What is printed of a motion, and what the outputs keep from instant to instant.
   type :: printing_t
      logical :: lists = .false.             !< the listing has tables over the instants
      logical :: each = .false.              !< something is printed at every instant
      type(listing_state_t) :: state
      type(column_table_t) :: columns
      integer, allocatable :: every(:)       !< rows are printed at each so many instants
      integer :: next = 0, last = 0          !< instants from 0: the next with rows, and the last of all
      type(finished_row_t), allocatable :: rows(:)   !< (requests of the set) of the last instant that was printed
   end type printing_t

contains

   !> Begins what is printed of the motion of `a`. `full`: its tables are in the listing, too.
   subroutine begin_printing(p, o, a, full)
      type(printing_t), intent(out) :: p
      type(writers_t), intent(in) :: o
      type(set_analysis_t), intent(in) :: a
      logical, intent(in) :: full
      integer :: i

      p%lists = full .and. o%asked(out_listing)
      if (p%lists) call new_column_table(o%layout, a%now, p%columns)
      p%each = o%asked(out_table) .or. o%asked(out_log) .or. allocated(p%columns%columns)
      allocate (p%rows(size(a%now%rows)))
      p%every = [(merge(1, a%now%parts(i)%requests%every, a%now%parts(i)%requests%in_columns), i=1, a%now%count)]
      p%every = pack(p%every, p%every > 0)
      p%last = instant_count(a%now) - 1
      p%next = merge(0, huge(p%next), size(p%every) > 0)
   end subroutine begin_printing

   !> Tells whether rows are printed at instant `k`, counted from 0, and finds the next such instant. The instants are
   !> passed in their order. Reason: a division for each request at every instant takes longer than all else here.
   logical function is_next(p, k)
      type(printing_t), intent(inout) :: p
      integer, intent(in) :: k

      is_next = k == p%next .or. (k == p%last .and. size(p%every) > 0)
      if (k == p%next) p%next = k + minval(p%every - mod(k, p%every))
   end function is_next

   !> Prints instant `k`, counted from 0, to which `a` has advanced, in each output that has something of it. If rows
   !> are not printed at it, an instant without remarks has nothing to print, unless p%each. Errors are estimated only
   !> for what is shown.
   subroutine print_instant(p, o, a, k, due)
      type(printing_t), intent(inout) :: p
      type(writers_t), intent(inout) :: o
      type(set_analysis_t), intent(inout) :: a
      integer, intent(in) :: k
      logical, intent(in) :: due             !< rows are printed at it
      logical :: lists, has_csv
      integer :: i

      has_csv = due .and. o%asked(out_csv)
      if (o%asked(out_table) .or. has_csv .or. (due .and. p%lists)) call sample_set(a, o%options%errors)
      lists = p%lists .and. (due .or. has_words(a%now))
      if (lists .or. has_csv .or. o%asked(out_table)) &
         call find_rows(a%now, k, o%asked(out_table) .or. allocated(p%columns%columns), p%rows, a%assemblies)

      if (lists) then
         if (p%columns%alone) then
            call listing_instant(p%columns%remarks, o%layout, a%now, p%rows, k, p%state)
         else
            call listing_instant(o%files(out_listing), o%layout, a%now, p%rows, k, p%state)
         end if
      end if
      if (allocated(p%columns%columns)) call note_columns(p%columns, o%layout, a%now, p%rows)
      if (has_csv) call csv_instant(o%files(out_csv), a%now, p%rows, k, o%varies)
      if (o%asked(out_table)) call table_instant(o%files(out_table), o%table, a%now, p%rows)
      if (o%asked(out_log)) then
         do i = 1, size(a%list)
            call log_instant(o%files(out_log), k, instant(a%now, k), a%list(i)%convergence, a%list(i)%branch)
         end do
      end if
   end subroutine print_instant

   !> Ends the tables over the instants, after the last one or where the run is broken off.
   subroutine end_tables(p, o, a)
      type(printing_t), intent(inout) :: p
      type(writers_t), intent(inout) :: o
      type(set_analysis_t), intent(in) :: a

      if (.not. p%lists) return
      if (p%columns%alone) then
         call put_untold(p%columns%remarks, a%now%polish, p%state)
      else
         call put_untold(o%files(out_listing), a%now%polish, p%state)
      end if
      call put_columns(o%files(out_listing), p%columns, a%now)
   end subroutine end_tables

   !> Prints how the motion of `a` ended, with the counts of its instants: the end of its part of the listing.
   subroutine print_end(p, o, a, counts)
      type(printing_t), intent(in) :: p
      type(writers_t), intent(inout) :: o
      type(set_analysis_t), intent(in) :: a
      class(counts_t), intent(in) :: counts
      integer :: i

      if (.not. p%lists) return
      call listing_end(o%files(out_listing), a%now, counts%solved, counts%flagged, set_certificates(a), &
         maxval([(redundancy_error(a%list(i)), i=1, size(a%list))]), &
         maxval([(a%estimators(i)%closure, i=1, size(a%list))]), set_closing_diagnostics(a))
   end subroutine print_end

   !> Ends the run before its time. The last line of the listing of `m` has the `words` and the `number` of the last
   !> instant, variant or set; nothing follows it.
   subroutine break_off(o, m, words, number)
      type(writers_t), intent(inout) :: o
      class(settings_t), intent(in) :: m
      type(phrase_t), intent(in) :: words
      integer, intent(in) :: number          !< from 1; of an instant from 0

      if (o%ended) return
      o%ended = .true.
      if (.not. o%asked(out_listing)) return
      call put(o%files(out_listing), '')
      call put(o%files(out_listing), ' *** '//phrase(words, m%polish)//' '//whole(number))
   end subroutine break_off
end module writers
