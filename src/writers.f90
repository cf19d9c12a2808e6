!> The outputs of a job, and the text of a motion: at its beginning, at its instants and at its end. This module alone
!> knows the order of the outputs; `motion_run` and `variant_runs` know only its procedures.
module writers
   use failures, only: status_solved
   use mechanism, only: settings_t, request_t, instant, instant_count
   use set_members, only: requests_of
   use deck_variants, only: variation_t
   use text_output, only: put
   use command_line, only: options_t, out_listing, out_csv, out_table, out_log
   use outputs, only: outputs_t
   use listing, only: layout_t, listing_state_t, listing_instant, listing_end, write_waiting
   use column_table, only: column_table_t, new_column_table, add_table_line, write_columns
   use csv, only: csv_instant, table_t, table_instant
   use solver_log, only: log_instant
   use counts, only: counts_t
   use answers, only: answers_t
   use extremes_table, only: write_extremes
   use ranges_table, only: write_ranges
   use assembly_table, only: write_assemblies
   use circuits_table, only: write_circuits
   use contributions_table, only: write_shares
   use proof_table, only: write_proofs
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
      type(options_t) :: options                    !< of the command
      integer :: status = status_solved             !< the exit status of what was computed
      integer :: first = 1, last = 0                !< the sets that were read
      type(layout_t) :: layout                      !< of the listing of the set that is computed
      type(table_t) :: table                        !< of the set that is computed
      logical :: varies = .false.                   !< the deck has VARY cards
      type(variation_t), allocatable :: variations(:)   !< (sets of the deck) empty without VARY cards
   end type writers_t

   !> The instants of a motion that are printed, and all that the outputs keep from instant to instant.
   type :: printing_t
      logical :: lists = .false.             !< the listing has tables over the instants
      logical :: each = .false.              !< something is printed at every instant
      type(listing_state_t) :: state         !< what the listing has printed so far
      type(column_table_t) :: columns        !< of the COLUMN cards
      integer, allocatable :: every(:)       !< (requests with rows) rows are printed at each so many instants
      integer :: next = 0, last = 0          !< instants from 0: the next with rows, and the last of all
      type(finished_row_t), allocatable :: rows(:)   !< (requests of the set) of the last instant that was printed
   end type printing_t

contains

   !> Finds which outputs and which instants of the motion of a set are printed.
   subroutine begin_printing(printing, writers, set, full)
      type(printing_t), intent(out) :: printing   !< of the motion
      type(writers_t), intent(in) :: writers   !< open
      type(set_analysis_t), intent(in) :: set   !< before its first instant
      logical, intent(in) :: full            !< the listing has the tables of the set
      type(request_t), allocatable :: requests(:)

      printing%lists = full .and. writers%asked(out_listing)
      if (printing%lists) call new_column_table(writers%layout, set%now, printing%columns)
      printing%each = writers%asked(out_table) .or. writers%asked(out_log) .or. allocated(printing%columns%columns)
      allocate (printing%rows(size(set%now%rows)))
      requests = requests_of(set%now)
      printing%every = merge(1, requests%every, requests%in_columns)
      printing%every = pack(printing%every, printing%every > 0)
      printing%last = instant_count(set%now) - 1
      printing%next = merge(0, huge(printing%next), size(printing%every) > 0)
   end subroutine begin_printing

   !> Tells whether rows are printed at an instant, and finds the next such instant. Reason: a division for each request
   !> at every instant takes longer than all else here.
   logical function is_next(printing, k)
      type(printing_t), intent(inout) :: printing   !< gets the next instant with rows
      integer, intent(in) :: k               !< the instant, counted from 0; one call for each, in their order

      is_next = k == printing%next .or. (k == printing%last .and. size(printing%every) > 0)
      if (k == printing%next) printing%next = k + minval(printing%every - mod(k, printing%every))
   end function is_next

   !> Prints the instant to which a set has advanced, in each output that takes something of it. Errors are estimated
   !> only for numbers that are printed. An instant without rows and without remarks has nothing to print, unless
   !> printing%each.
   subroutine print_instant(printing, writers, set, k, due)
      type(printing_t), intent(inout) :: printing   !< gets the rows of the instant
      type(writers_t), intent(inout) :: writers   !< get the text of the instant
      type(set_analysis_t), intent(inout) :: set   !< at the instant
      integer, intent(in) :: k               !< the instant, counted from 0
      logical, intent(in) :: due             !< rows are printed at the instant
      logical :: lists, has_csv
      integer :: i

      has_csv = due .and. writers%asked(out_csv)
      if (writers%asked(out_table) .or. has_csv .or. (due .and. printing%lists)) call sample_set(set, &
         writers%options%errors)
      lists = printing%lists .and. (due .or. has_words(set%now))
      if (lists .or. has_csv .or. writers%asked(out_table)) &
         call find_rows(set%now, set%assemblies, k, writers%asked(out_table) .or. &
            allocated(printing%columns%columns), printing%rows)

      if (lists) then
         if (printing%columns%is_only) then
            call listing_instant(printing%columns%remarks, writers%layout, set%now, printing%rows, k, printing%state)
         else
            call listing_instant(writers%files(out_listing), writers%layout, set%now, printing%rows, k, printing%state)
         end if
      end if
      if (allocated(printing%columns%columns)) call add_table_line(printing%columns, writers%layout, set%now, &
         printing%rows)

      if (has_csv) call csv_instant(writers%files(out_csv), set%now, printing%rows, k, writers%varies)
      if (writers%asked(out_table)) call table_instant(writers%files(out_table), writers%table, set%now, printing%rows)
      if (writers%asked(out_log)) then
         do i = 1, size(set%list)
            call log_instant(writers%files(out_log), k, instant(set%now, k), set%list(i)%convergence, &
               set%list(i)%branch)
         end do
      end if
   end subroutine print_instant

   !> Ends the tables over the instants, after the last one or when the run is broken off.
   subroutine end_tables(printing, writers, set)
      type(printing_t), intent(inout) :: printing   !< with the instants so far
      type(writers_t), intent(inout) :: writers   !< get the ends of the tables
      type(set_analysis_t), intent(in) :: set   !< after its last instant

      if (.not. printing%lists) return
      if (printing%columns%is_only) then
         call write_waiting(printing%columns%remarks, set%now%polish, printing%state)
      else
         call write_waiting(writers%files(out_listing), set%now%polish, printing%state)
      end if
      call write_columns(writers%files(out_listing), printing%columns, set%now)
   end subroutine end_tables

   !> Prints the end of the listing of a set: the answers to its cards, and how its motion ended, with the counts of its
   !> instants.
   subroutine print_end(printing, writers, set, counts, answers)
      type(printing_t), intent(in) :: printing   !< of the motion
      type(writers_t), intent(inout) :: writers   !< the listing gets the text
      type(set_analysis_t), intent(in) :: set   !< after its last instant
      class(counts_t), intent(in) :: counts   !< of the run
      type(answers_t), intent(in) :: answers   !< to the cards of the set
      integer :: i

      if (.not. printing%lists) return
      associate (o => writers%files(out_listing), l => writers%layout)
         if (answers%wants_extremes) call write_extremes(o, l, set%now, answers%extremes, answers%dwells)
         if (set%now%ranges) call write_ranges(o, set%now, answers%ranges)
         if (set%now%assemblies) call write_assemblies(o, l, set)
         if (allocated(answers%circuits)) call write_circuits(o, set%now, answers%circuits)
         if (answers%wants_contributions) call write_shares(o, l, answers%shares, set%now)
         if (set%now%proves) call write_proofs(o, l, answers%proofs, set%now)
         call listing_end(o, set%now, counts%solved, counts%flagged, set_certificates(set), &
            maxval([(redundancy_error(set%list(i)), i=1, size(set%list))]), &
            maxval([(set%estimators(i)%closure, i=1, size(set%list))]), set_closing_diagnostics(set))
      end associate
   end subroutine print_end

   !> Ends the run before its time. The last line of the listing tells after which instant, variant or set; nothing
   !> follows it.
   subroutine break_off(writers, settings, words, number)
      type(writers_t), intent(inout) :: writers   !< become ended; the listing gets the line
      class(settings_t), intent(in) :: settings   !< of the set that is computed: the language
      type(phrase_t), intent(in) :: words    !< the sentence before the number
      integer, intent(in) :: number          !< of the last instant, from 0, or of the last variant or set, from 1

      if (writers%ended) return
      writers%ended = .true.
      if (.not. writers%asked(out_listing)) return
      call put(writers%files(out_listing), '')
      call put(writers%files(out_listing), ' *** '//phrase(words, settings%polish)//' '//whole(number))
   end subroutine break_off
end module writers
