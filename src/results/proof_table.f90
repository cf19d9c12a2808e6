!> The results of card PROVE in the listing: a line for each printed instant, with the steps to it since the one before;
!> why instants are not proved; and the counts.
module proof_table
   use kinds, only: wp
   use mechanism, only: instant
   use motion, only: flag_none
   use independent, only: set_t
   use set_members, only: link_names
   use proofs, only: proofs_t, reason_t
   use names, only: listed
   use listing, only: words_of_flag
   use listing_layout, only: layout_t, write_folded
   use table, only: right
   use listing_tables, only: time_text
   use text_output, only: output_t, put
   use number_format, only: whole
   use phrases
   implicit none
   private
   public :: write_proofs

   !> Characters of a column.
   integer, parameter :: column_width = 12

contains

   !> Writes the proofs of a set after its last instant.
   subroutine write_proofs(o, l, proofs, set)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(proofs_t), intent(in) :: proofs   !< after the last instant
      class(set_t), intent(in) :: set        !< of the proofs
      character(:), allocatable :: start, closure_error
      integer :: i

      call put(o, '')
      call put(o, ' '//phrase(text_proof, set%polish))
      call put(o, column(phrase(text_instant, set%polish))//column('T')//column(phrase(text_parts, set%polish)) &
         //column(phrase(text_tube, set%polish))//column(phrase(text_position, set%polish)) &
         //column(phrase(text_velocity, set%polish))//'  '//column(phrase(text_acceleration, set%polish)))
      do i = 1, proofs%count
         associate (line => proofs%lines(i))
            start = column(whole(line%step))//column(time_text(l, instant(set, line%step)))
            if (line%is_proved) then
               call put(o, start//column(whole(line%parts))//column(rounded_up(line%tube)) &
                  //column(rounded_up(line%bounds(0)))//column(rounded_up(line%bounds(1))) &
                  //'  '//column(rounded_up(line%bounds(2))))
            else
               call put(o, start//'   '//phrase(text_not_proved, set%polish))
            end if
         end associate
      end do

      do i = 1, size(proofs%reasons)
         associate (r => proofs%reasons(i))
            call write_folded(o, ' *** ', phrase(text_instant, set%polish)//' '//whole(r%step)//', T = ' &
               //time_text(l, instant(set, r%step))//': '//phrase(text_not_proved, set%polish)//': '//words_of(r, set))
         end associate
      end do
      if (proofs%instants - proofs%proved > size(proofs%reasons)) call put(o, ' *** ' &
         //phrase(text_not_proved, set%polish)//': '//whole(proofs%instants - proofs%proved))

      closure_error = ''
      if (proofs%closure_error > 0.0_wp) &
         closure_error = ',  '//phrase(text_closure_error_of, set%polish)//' '//rounded_up(proofs%closure_error)
      call put(o, ' '//phrase(text_proved, set%polish)//' '//whole(proofs%proved)//' / '//whole(proofs%instants) &
         //',  '//phrase(text_parts, set%polish)//' '//whole(sum(proofs%lines(:proofs%count)%parts)) &
         //',  '//phrase(text_tube, set%polish)//' '//rounded_up(maxval([0.0_wp, proofs%lines(:proofs%count)%tube])) &
         //closure_error)
   end subroutine write_proofs

   !> Gives the reason why an instant is not proved in words.
   function words_of(reason, set) result(words)
      type(reason_t), intent(in) :: reason   !< of an instant of the set
      class(set_t), intent(in) :: set          !< of the reason
      character(:), allocatable :: words

      if (reason%flag /= flag_none) then
         words = words_of_flag(reason%flag, reason%singularity, set%polish)
      else if (reason%is_crossed) then
         words = phrase(text_change_inside, set%polish)
      else
         words = phrase(text_near_singular, set%polish)
         if (reason%too_many > 0) words = phrase(text_too_wide, set%polish)//' '//whole(reason%too_many)
         if (.not. allocated(reason%links)) return
         if (size(reason%links) > 0) words = phrase(text_links, set%polish)//' ' &
            //listed(link_names(set, reason%part, reason%links), set%polish)//': '//words
      end if
   end function words_of

   !> Gives a text at the right of a column.
   pure function column(text)
      character(*), intent(in) :: text       !< at most as long as the column
      character(column_width) :: column

      column = right(text, column_width)
   end function column

   !> Gives a number with one digit, rounded up; 0 is exact.
   pure function rounded_up(value) result(text)
      real(wp), intent(in) :: value              !< at least 0
      character(:), allocatable :: text
      character(8) :: field
      real(wp) :: large
      integer :: first, power, digit

      text = '0'
      if (.not. value > 0.0_wp) return
      ! Numbers next to the end of the range are none.
      large = min(max(value, tiny(value)/epsilon(value)**2), huge(value)*epsilon(value)**2)
      ! The power of ten is that of the power of two, or one more.
      first = floor((exponent(large) - 1)*log10(2.0_wp))
      do power = first, first + 1
         digit = max(1, ceiling(large/10.0_wp**power))
         if (digit <= 9) exit
      end do
      write (field, '(i0, a, sp, i0.2)') digit, '.E', max(-999, min(power, 999))
      text = trim(field)
   end function rounded_up
end module proof_table
